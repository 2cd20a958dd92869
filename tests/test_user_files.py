"""Only a regular file of a bounded size is read, and never for longer than a disk may take."""

import os
import socket
import threading
from pathlib import Path

import pytest

from vision_core import user_files
from vision_core.errors import SettingsError, SourceError
from vision_core.user_files import check_regular, read_bytes, read_text


def read(path: Path, max_bytes: int = 100) -> bytes:
    return read_bytes(path, f"file {path.name}", SourceError, max_bytes=max_bytes)


def test_a_file_up_to_its_limit_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(bytes(range(100)))
    assert read(path) == bytes(range(100))
    assert read_bytes(path, "a", SourceError, max_bytes=10, only_first=True) == bytes(range(10))


def test_a_larger_file_is_refused_by_its_size(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(bytes(101))
    with pytest.raises(SourceError, match=r"file a.bin; found: 101 bytes; accepted: at most 100 bytes"):
        read(path)


def test_a_file_that_grows_past_its_limit_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(bytes(300))
    status = os.stat_result((path.stat().st_mode, 0, 0, 1, 0, 0, 50, 0, 0, 0))
    monkeypatch.setattr(os, "fstat", lambda _file: status)
    with pytest.raises(SourceError, match="found: more than 100 bytes"):
        read(path)


def test_what_never_ends_is_no_regular_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(str(tmp_path / "socket"))
    with listener:
        for path, kind in (
            (tmp_path / "pipe", "a FIFO"),
            (Path("/dev/zero"), "a device"),
            (tmp_path, "a folder"),
            (tmp_path / "socket", "No such device or address"),
            (tmp_path / "absent", "No such file or directory"),
            (Path("nul\0"), "null"),
        ):
            with pytest.raises(SourceError, match=f"found: .*{kind}"):
                check_regular(path, "file", SourceError)
            with pytest.raises(SourceError, match=f"found: .*{kind}"):
                read(path)


def test_a_disk_that_does_not_answer_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.bin").write_bytes(b"a")
    answers = threading.Event()

    def blocked(_file: int, _size: int) -> bytes:
        answers.wait()
        return b""

    monkeypatch.setattr(os, "read", blocked)
    monkeypatch.setattr(user_files, "READ_TIMEOUT_S", 0.01)
    with pytest.raises(SourceError, match="found: a disk that did not deliver it in 0.01 s"):
        read(tmp_path / "a.bin")
    answers.set()


def test_text_is_utf_8_with_or_without_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    for data in ("größe = 1\n".encode(), "größe = 1\n".encode("utf-8-sig")):
        path.write_bytes(data)
        assert read_text(path, "a", SettingsError, max_bytes=100) == "größe = 1\n"
    path.write_bytes(b"a = 1\nb = '\xfc'\n")
    with pytest.raises(SettingsError, match="found: byte 0xfc in line 2, which is not UTF-8"):
        read_text(path, "a", SettingsError, max_bytes=100)
