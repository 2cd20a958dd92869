"""Where the control sockets of services lie: files in a folder that only their user can enter.

The service "pslv/8000" listens at ``pslv-8000.sock`` in the first folder that is the user's own. Where others have
taken every usual name, the service makes a folder under a name of its own. Root finds the services of all users.
"""

import os
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

from vision_core.native.private_folder import PrivateFolder

PREFIX = "pslv/"
"""Begins the names of services."""
SHARED = (Path("/dev/shm"), Path("/tmp"))  # noqa: S108 (every folder in them is judged by owner and mode)
ENDING = ".sock"


def path_for(name: str) -> Path:
    """Where a service of this user is to listen. Raises OSError when there is no folder for it at all."""
    user = os.geteuid()
    for path in (Path(f"/run/user/{user}/pslv"), *(shared / f"pslv-{user}" for shared in SHARED)):
        if path.parent.is_dir() and _is_ours(path):
            return path / _file_of(name)
    return Path(tempfile.mkdtemp(prefix=f"pslv-{user}-", dir=SHARED[-1])) / _file_of(name)


def paths_of(name: str) -> list[Path]:
    """Where a service of this name may listen; root is told those of all users."""
    return [folder / _file_of(name) for folder in _folders() if (folder / _file_of(name)).is_socket()]


def names() -> list[str]:
    """Names of all services that have a socket; one that was killed may have left its own behind."""
    files = [path.stem for folder in _folders() for path in folder.glob(f"pslv-*{ENDING}")]
    return sorted({f"{PREFIX}{stem.removeprefix('pslv-')}" for stem in files})


def _file_of(name: str) -> str:
    return name.replace("/", "-") + ENDING


def _is_ours(path: Path) -> bool:
    """Is this folder private to this user, once it is made where there is none?"""
    try:
        PrivateFolder.open(path, follow_link=False).close()
    except OSError:
        return False
    return path.stat().st_uid == os.geteuid() and not path.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO)


def _folders() -> Iterator[Path]:
    """Folders in which services of this user may listen, or for root those of any user."""
    user = os.geteuid()
    places = [(Path("/run/user"), "*/pslv"), *((shared, "pslv-*") for shared in SHARED)]
    for root, pattern in places:
        for folder in sorted(root.glob(pattern)):
            found = folder.lstat()
            if stat.S_ISDIR(found.st_mode) and user in (0, found.st_uid):
                yield folder
