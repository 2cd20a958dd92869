"""Where the compiled kernels of this code lie on disk: ``PSLV_DATA_DIR/jit/<fingerprint>``.

Where the data folder cannot be used (another user can write into it, it cannot be written, its disk is full), a folder
of our own in memory is taken, and one line says so. A folder that is complete holds a mark for each kind of source: the
list of the files that a start with such a source loads.
"""

import errno
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from vision_core.native.fingerprint import PACKAGE, kernel_fingerprint
from vision_core.native.private_folder import DamagedFileError, PrivateFolder

VARIABLE = "PSLV_KERNEL_ROOT"
"""Names the folder that the service took in place of the data folder; its processes inherit it, and check it again."""
MARK = "complete-"
ROOM_BYTES = 32 << 20
"""A full set of kernels takes a third of it."""
VERSIONS_KEPT = 5
"""Fingerprints whose kernels stay on disk, those used last."""

DAMAGED = "{}: damaged files are deleted, and their kernels compiled again"
"""A line for the log; it takes the folder."""


@dataclass(frozen=True, slots=True)
class CompiledKernel:
    """What one file holds, beside machine code."""

    kernel: str
    """Module and name."""
    signature: str
    seconds: float
    """Processor time that it took to compile, without the kernels that it calls."""

    def encode(self, code: bytes) -> bytes:
        """The content of a file: a line of JSON, then the machine code as numba writes it."""
        return json.dumps(asdict(self)).encode() + b"\n" + code


def machine_code(content: bytes) -> bytes:
    """The second part of a file's content."""
    return content.partition(b"\n")[2]


def data_folder() -> Path:
    """Where the service keeps its state: ``PSLV_DATA_DIR``, or the platform's user data folder."""
    if chosen := os.environ.get("PSLV_DATA_DIR"):
        return Path(chosen).expanduser().absolute()
    from platformdirs import user_data_path

    return user_data_path("pslv", appauthor=False)


def choose_kernel_folder() -> tuple[PrivateFolder | None, str]:
    """Open the folder of compiled kernels of this code on this machine, and make it where there is none.

    Returns None when no folder can be used at all; and a line for the log when it is not in the data folder.
    """
    given = os.environ.get(VARIABLE)
    if given:
        try:
            return _open(Path(given), follow_link=False), ""
        except OSError:
            pass
    try:
        return _open(data_folder(), follow_link=True), ""
    except OSError as error:
        reason = _in_words(error)
    for root in _private_roots():
        try:
            folder = _open(root, follow_link=False)
        except OSError:
            continue
        return folder, f"{reason}: compiled kernels are kept in {folder.path} instead"
    return None, f"{reason}: every process compiles its kernels in memory"


def is_complete(folder: PrivateFolder, kind: str) -> bool:
    """Are all kernels there, undamaged, that a start with such a source loads?"""
    try:
        mark = folder.read(MARK + kind)
        return mark is not None and all(folder.read(name) is not None for name in json.loads(mark))
    except DamagedFileError:
        return False


def mark_complete(folder: PrivateFolder, kind: str) -> None:
    """Note that all kernels are there that a start with such a source loads. Raises OSError."""
    folder.write(MARK + kind, json.dumps(kernel_files(folder)).encode())


def kernel_files(folder: PrivateFolder) -> list[str]:
    """Names of the compiled kernels, sorted."""
    return [name for name in folder.names() if not name.startswith(MARK)]


def compiled_kernels(folder: PrivateFolder, names: Iterable[str]) -> list[CompiledKernel]:
    """What files hold; those that are not there are left out. Raises DamagedFileError."""
    contents = (folder.read(name) for name in names)
    return [CompiledKernel(**json.loads(content.partition(b"\n")[0])) for content in contents if content is not None]


def delete_damaged(folder: PrivateFolder) -> int:
    """Delete the files that are not what was written; returns how many there were."""
    return sum(_delete_if_damaged(folder, name) for name in folder.names())


def delete_old_versions(folder: PrivateFolder) -> None:
    """Delete the kernels of other fingerprints, except those used last."""
    versions = sorted(
        (path for path in folder.path.parent.iterdir() if path.is_dir()),
        key=lambda path: path.stat().st_mtime,
        reverse=True,
    )
    for old in versions[VERSIONS_KEPT:]:
        shutil.rmtree(old, ignore_errors=True)


def _open(root: Path, *, follow_link: bool) -> PrivateFolder:
    """The kernels' folder below a root. Raises OSError when it cannot be used."""
    base = PrivateFolder.open(root, follow_link=follow_link)
    try:
        versions = base.subfolder("jit")
    finally:
        base.close()
    try:
        folder = versions.subfolder(_fingerprint(versions))
    finally:
        versions.close()
    try:
        if not any(name.startswith(MARK) for name in folder.names()):
            if not folder.is_writable():
                raise PermissionError(errno.EACCES, "it cannot be written", str(folder.path))
            if folder.free_bytes() < ROOM_BYTES:
                raise OSError(errno.ENOSPC, f"its disk has less than {ROOM_BYTES >> 20} MB left", str(folder.path))
    except OSError:
        folder.close()
        raise
    folder.mark_used()
    return folder


def _fingerprint(versions: PrivateFolder) -> str:
    """The fingerprint of this code, with the hashes of files that were parsed before."""
    name = "sources" + str(PACKAGE).replace(os.sep, "-") + ".json"
    try:
        hashes: dict[str, str] = json.loads(versions.read(name) or b"{}")
    except DamagedFileError:
        hashes = {}
    before = dict(hashes)
    fingerprint = kernel_fingerprint(hashes)
    if hashes != before:
        _write_if_possible(versions, name, json.dumps(hashes).encode())
    return fingerprint


def _write_if_possible(folder: PrivateFolder, name: str, content: bytes) -> None:
    """Write what only saves time; nothing on a full disk."""
    try:
        folder.write(name, content)
    except OSError:
        return


def _delete_if_damaged(folder: PrivateFolder, name: str) -> bool:
    try:
        folder.read(name)
    except DamagedFileError:
        folder.delete(name)
        return True
    return False


def _private_roots() -> Iterator[Path]:
    """Folders of our own outside the data folder, those in memory first."""
    if runtime := os.environ.get("XDG_RUNTIME_DIR"):
        yield Path(runtime) / "pslv"
    for shared in ("/dev/shm", tempfile.gettempdir()):  # noqa: S108 (judged by owner and mode when it is opened)
        yield Path(shared) / f"pslv-{os.geteuid()}"


def _in_words(error: OSError) -> str:
    """A reason for the log: the folder and what is wrong with it."""
    return f"{error.filename}: {error.strerror}" if error.strerror else str(error)
