"""What commands share that look at a running service, or run a part of one."""

import subprocess
import sys

from vision_core.errors import PslvError


def child_of_python(module: str, *arguments: str) -> bytes:
    """Run a module in a process of its own; what it prints. Raises PslvError with its last words when it fails."""
    done = subprocess.run([sys.executable, "-m", module, *arguments], capture_output=True, check=False)
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines() or ["no word"]
        raise PslvError(module, found=lines[-1])
    return done.stdout
