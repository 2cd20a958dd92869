"""For commands that look at a running service, or run a part of one."""

import subprocess
import sys

from vision_core.errors import PslvError, ServiceError


def child_of_python(module: str, *arguments: str) -> bytes:
    """The output of a module that runs in a process of its own. Raises PslvError with its last line when it fails."""
    done = subprocess.run([sys.executable, "-m", module, *arguments], capture_output=True, check=False)
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines() or ["no message"]
        raise PslvError(module, found=lines[-1])
    return done.stdout


def only_service(command: str) -> str:
    """Name of the service that runs on this machine. Raises ServiceError when there is none, or more than one."""
    from vision_core.net.control import running_services

    names = running_services()
    if len(names) == 1:
        return names[0]
    found = f"{len(names)} services that run: {', '.join(names)}" if names else "no service that runs here"
    raise ServiceError(command, found=found, accepted="the name of one" if names else "pslv serve")
