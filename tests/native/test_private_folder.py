"""Only what we, or root, wrote and nobody changed is read."""

import os
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from vision_core.native.private_folder import DamagedFileError, PrivateFolder


@pytest.fixture
def folder(tmp_path: Path) -> PrivateFolder:
    return PrivateFolder.open(tmp_path / "own", follow_link=False)


def test_what_is_written_is_read(folder: PrivateFolder) -> None:
    folder.write("b", b"first")
    folder.write("b", b"second")
    folder.write("a", b"")
    assert folder.names() == ["a", "b"]
    assert folder.read("b") == b"second"
    assert folder.read("a") == b""
    assert folder.read("c") is None
    folder.delete("a")
    folder.delete("a")
    assert folder.names() == ["b"]


def test_nobody_else_can_look_inside(folder: PrivateFolder) -> None:
    folder.subfolder("in").write("file", b"text")
    for path in (folder.path, folder.path / "in", folder.path / "in" / "file"):
        assert not path.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO)


@pytest.mark.parametrize(
    "damage", [lambda data: data[:-1], lambda data: data[:5], lambda _: b"", lambda data: data[::-1]]
)
def test_a_damaged_file_is_detected(folder: PrivateFolder, damage: Callable[[bytes], bytes]) -> None:
    folder.write("file", b"text")
    path = folder.path / "file"
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(DamagedFileError, match="file: its checksum is wrong"):
        folder.read("file")


def test_a_link_to_a_file_is_not_followed(folder: PrivateFolder, tmp_path: Path) -> None:
    folder.write("file", b"text")
    (folder.path / "file").rename(tmp_path / "elsewhere")
    (folder.path / "file").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(DamagedFileError):
        folder.read("file")


@pytest.mark.parametrize("mode", [0o770, 0o702, 0o777, 0o1777])
def test_a_folder_that_others_can_write_is_refused(folder: PrivateFolder, mode: int) -> None:
    (folder.path / "in").mkdir()
    (folder.path / "in").chmod(mode)
    with pytest.raises(PermissionError, match=f"in can be written by other users .mode {mode:o}."):
        folder.subfolder("in")


def test_a_folder_of_another_user_is_refused(folder: PrivateFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    owner = folder.path.stat().st_uid
    monkeypatch.setattr(os, "geteuid", lambda: owner + 1)
    if owner == 0:  # what root wrote everybody may read
        folder.subfolder("in")
        os.chown(folder.path / "in", 54321, -1)
    with pytest.raises(PermissionError, match="in belongs to another user"):
        folder.subfolder("in")


def test_a_link_to_a_folder_is_followed_only_when_asked(folder: PrivateFolder, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(folder.path)
    folder.write("file", b"text")
    assert PrivateFolder.open(tmp_path / "link", follow_link=True).read("file") == b"text"
    with pytest.raises(OSError, match="link"):
        PrivateFolder.open(tmp_path / "link", follow_link=False)
    (folder.path / "in").symlink_to(tmp_path)
    with pytest.raises(OSError, match="in"):
        folder.subfolder("in")


def test_a_folder_that_replaces_an_open_one_is_not_used(folder: PrivateFolder, tmp_path: Path) -> None:
    folder.write("file", b"ours")
    folder.path.rename(tmp_path / "moved")
    PrivateFolder.open(folder.path, follow_link=False).write("file", b"theirs")
    assert folder.read("file") == b"ours"


def test_what_cannot_be_written_leaves_nothing(folder: PrivateFolder) -> None:
    (folder.path / "taken").mkdir()
    with pytest.raises(OSError, match="irectory"):
        folder.write("taken", b"text")
    assert [entry.name for entry in folder.path.iterdir()] == ["taken"]
