"""Reads files that a user names: settings, venues, patterns, pictures, truth.

Every such file is opened here, so that each gets the same checks before anything of it is parsed: it must be a regular
file (a FIFO or /dev/zero never ends), no larger than its kind may be, and its disk must deliver it in time. Text is
UTF-8 with or without a byte order mark.
"""

import os
import stat
from pathlib import Path
from threading import Thread

from vision_core.errors import PslvError

READ_TIMEOUT_S = 10.0
"""A disk that takes longer than this for one file (a network share that is gone) is given up."""
CHUNK_BYTES = 1 << 20
FILE_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a FIFO"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


def read_bytes(path: Path, asked: str, error: type[PslvError], *, max_bytes: int, only_first: bool = False) -> bytes:
    """The content of a regular file.

    asked: what a message calls the file, "picture a.png"; error: the exception to raise; only_first: read at most
    max_bytes and ignore the rest.
    Raises error when the file cannot be opened, is no regular file, has more than max_bytes bytes, or takes longer than
    READ_TIMEOUT_S.
    """
    done: list[bytes | PslvError] = []

    def read() -> None:
        try:
            done.append(_read(path, asked, error, max_bytes, only_first))
        except PslvError as problem:
            done.append(problem)

    reader = Thread(target=read, name=f"read {path.name}", daemon=True)  # a blocked read cannot be interrupted
    reader.start()
    reader.join(READ_TIMEOUT_S)
    if not done:
        raise error(asked, found=f"a disk that did not deliver it in {READ_TIMEOUT_S:g} s", accepted="a local file")
    if isinstance(done[0], PslvError):
        raise done[0]
    return done[0]


def read_text(path: Path, asked: str, error: type[PslvError], *, max_bytes: int) -> str:
    """The content of a text file in UTF-8, without its byte order mark; otherwise as ``read_bytes``."""
    data = read_bytes(path, asked, error, max_bytes=max_bytes)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        found = f"byte 0x{data[problem.start]:02x} in line {line}, which is not UTF-8"
        raise error(asked, found=found, accepted="a text file in UTF-8") from None


def check_regular(path: Path, asked: str, error: type[PslvError]) -> None:
    """Raise error unless a path names a regular file that can be opened: for readers that open it by name."""
    read_bytes(path, asked, error, max_bytes=1, only_first=True)


def _read(path: Path, asked: str, error: type[PslvError], max_bytes: int, only_first: bool) -> bytes:
    try:
        file = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)  # opening a FIFO would wait for its writer
    except (OSError, ValueError) as problem:  # ValueError: a NUL character in the name
        found = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        raise error(asked, found=found, accepted="a file that can be read") from None
    try:
        status = os.fstat(file)
        if not stat.S_ISREG(status.st_mode):
            kind = next((name for is_kind, name in FILE_KINDS if is_kind(status.st_mode)), "no regular file")
            raise error(asked, found=kind, accepted="a regular file")
        if status.st_size > max_bytes and not only_first:
            raise error(asked, found=f"{status.st_size} bytes", accepted=f"at most {max_bytes} bytes")
        chunks: list[bytes] = []
        room = max_bytes + (0 if only_first else 1)  # one more than allowed tells that the file grew
        while room > 0 and (data := os.read(file, min(CHUNK_BYTES, room))):
            chunks.append(data)
            room -= len(data)
    except OSError as problem:
        raise error(asked, found=problem.strerror or str(problem), accepted="a file that can be read") from None
    finally:
        os.close(file)
    if room == 0 and not only_first:
        raise error(asked, found=f"more than {max_bytes} bytes", accepted=f"at most {max_bytes} bytes")
    return b"".join(chunks)
