"""A folder that no other user can write into, whose files are complete or count as damaged.

Loading a compiled kernel executes what its file says, so a file is read only from a folder that belongs to the running
user (or root) and that nobody else can write. The folder is opened once, judged by its descriptor, and used through it:
a folder that is put in its place later is not seen. Every file starts with a checksum of the rest, and it appears under
its name only when it is complete, so that two processes may write the same file.
"""

import contextlib
import hashlib
import os
import stat
import uuid
from pathlib import Path

PRIVATE = 0o700
WRITABLE_BY_OTHERS = stat.S_IWGRP | stat.S_IWOTH
CHECKSUM_BYTES = hashlib.sha256().digest_size
_FOLDER = os.O_RDONLY | getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_CLOEXEC", 0)
_NO_LINK = getattr(os, "O_NOFOLLOW", 0)


class DamagedFileError(Exception):
    """A file is not what was written: it is cut off, or its checksum is another."""


class PrivateFolder:
    """An open folder. Raises PermissionError when another user owns it or can write into it."""

    def __init__(self, path: Path, descriptor: int) -> None:
        """path: for messages; descriptor: the open folder, which is closed when it is refused."""
        self.path = path
        self._folder = descriptor
        found = os.fstat(descriptor)
        if found.st_uid not in (os.geteuid(), 0):
            os.close(descriptor)
            raise PermissionError(f"{path} belongs to another user (id {found.st_uid})")
        if found.st_mode & WRITABLE_BY_OTHERS:
            os.close(descriptor)
            raise PermissionError(f"{path} can be written by other users (mode {stat.S_IMODE(found.st_mode):o})")

    @classmethod
    def open(cls, path: Path, *, follow_link: bool) -> "PrivateFolder":
        """Open a folder, and make it first where there is none, readable by us alone."""
        path.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileExistsError):
            path.mkdir(PRIVATE)
        return cls(path, os.open(path, _FOLDER | (0 if follow_link else _NO_LINK)))

    def subfolder(self, name: str) -> "PrivateFolder":
        """Open a folder inside, and make it first where there is none; a symbolic link is refused."""
        path = self.path / name
        try:
            with contextlib.suppress(FileExistsError):
                os.mkdir(name, PRIVATE, dir_fd=self._folder)
            descriptor = os.open(name, _FOLDER | _NO_LINK, dir_fd=self._folder)
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(path)) from None
        return PrivateFolder(path, descriptor)

    def is_writable(self) -> bool:
        """Can files be written, as far as permissions say? The disk may still be full."""
        return os.access(".", os.W_OK, dir_fd=self._folder)

    def free_bytes(self) -> int:
        """How much the disk can take."""
        disk = os.fstatvfs(self._folder)
        return disk.f_bavail * disk.f_frsize

    def mark_used(self) -> None:
        """Make this the folder that was changed last; nothing where that is not allowed."""
        with contextlib.suppress(OSError):
            os.utime(self._folder)

    def names(self) -> list[str]:
        """The files, sorted, without those that are being written."""
        with os.scandir(self._folder) as entries:
            return sorted(entry.name for entry in entries if not entry.name.startswith("."))

    def read(self, name: str) -> bytes | None:
        """A file's content; None: there is none. Raises DamagedFileError."""
        try:
            with open(name, "rb", opener=self._opener) as stream:
                checksum, content = stream.read(CHECKSUM_BYTES), stream.read()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise DamagedFileError(f"{self.path / name}: {error.strerror}") from None
        if hashlib.sha256(content).digest() != checksum:
            raise DamagedFileError(f"{self.path / name}: its checksum is wrong")
        return content

    def write(self, name: str, content: bytes) -> None:
        """Write a file, or replace it in one step. Raises OSError, with nothing left behind."""
        unfinished = f".{uuid.uuid4().hex}"
        try:
            with open(unfinished, "xb", opener=self._opener) as stream:
                stream.write(hashlib.sha256(content).digest())
                stream.write(content)
            os.replace(unfinished, name, src_dir_fd=self._folder, dst_dir_fd=self._folder)
        except OSError:
            self.delete(unfinished)
            raise

    def delete(self, name: str) -> None:
        """Delete a file; nothing where there is none or that is not allowed."""
        with contextlib.suppress(OSError):
            os.unlink(name, dir_fd=self._folder)

    def close(self) -> None:
        """Let go of the folder."""
        os.close(self._folder)

    def _opener(self, name: str, flags: int) -> int:
        """Open a file of this folder, not of the working folder; a symbolic link is refused."""
        return os.open(name, flags | _NO_LINK, 0o600, dir_fd=self._folder)
