"""What the service runs on: versions, operating system, processor."""

import os
import platform
import re
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

PACKAGES = ("opencv-python-headless", "numpy", "numba", "viser", "msgspec", "fastapi", "uvicorn", "websockets")


def versions_of(pslv: str) -> dict[str, Any]:
    """Versions by name. pslv: version of the service."""
    return {
        "pslv": pslv,
        "python": platform.python_version(),
        "system": _system(),
        "kernel": f"{platform.system()} {platform.release()} {platform.version()}",
        "machine": platform.machine(),
        "processor": _first_match(Path("/proc/cpuinfo"), r"^model name\s*:\s*(.+)$") or platform.processor(),
        "cores": os.cpu_count(),
        "usable_cores": len(os.sched_getaffinity(0)),
        "memory": _first_match(Path("/proc/meminfo"), r"^MemTotal:\s*(.+)$"),
        **{name: _installed(name) for name in PACKAGES},
    }


def _system() -> str:
    try:
        return platform.freedesktop_os_release().get("PRETTY_NAME", "")
    except OSError:
        return ""


def _installed(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _first_match(path: Path, pattern: str) -> str:
    """What the group of a pattern matches in a file; empty when there is no such file or line."""
    try:
        found = re.search(pattern, path.read_text(errors="replace"), re.MULTILINE)
    except OSError:
        return ""
    return found[1] if found else ""
