"""Which folder is taken for compiled kernels, and what is found in it."""

import json
import os
from pathlib import Path

import pytest

from vision_core.native import kernel_folder
from vision_core.native.kernel_folder import (
    VARIABLE,
    VERSIONS_KEPT,
    choose_kernel_folder,
    data_folder,
    delete_damaged,
    delete_old_versions,
    is_complete,
    kernel_files,
    mark_complete,
)
from vision_core.native.private_folder import PrivateFolder

FINGERPRINT = "0123456789abcdef"
LITTLE = "its disk has less than 32 MB left"


@pytest.fixture(autouse=True)
def _own_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fingerprint(hashes: dict[str, str]) -> str:
        hashes["of a file"] = "of its code"
        return FINGERPRINT

    monkeypatch.setattr(kernel_folder, "kernel_fingerprint", fingerprint)
    monkeypatch.setattr(kernel_folder, "_private_roots", lambda: iter([tmp_path / "first", tmp_path / "second"]))
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "data"))
    monkeypatch.setenv(VARIABLE, "")


def chosen() -> tuple[PrivateFolder, str]:
    folder, notice = choose_kernel_folder()
    assert folder is not None
    return folder, notice


def test_the_data_folder_is_taken_without_a_word(tmp_path: Path) -> None:
    folder, notice = chosen()
    assert (folder.path, notice) == (tmp_path / "data" / "jit" / FINGERPRINT, "")
    assert data_folder() == tmp_path / "data"


def test_hashes_of_sources_are_kept(tmp_path: Path) -> None:
    chosen()
    (file,) = (tmp_path / "data" / "jit").glob("sources-*.json")
    assert json.loads(file.read_bytes()[32:]) == {"of a file": "of its code"}
    file.write_bytes(b"damaged")
    chosen()
    assert json.loads(file.read_bytes()[32:]) == {"of a file": "of its code"}


@pytest.mark.parametrize("level", ["data", "data/jit", f"data/jit/{FINGERPRINT}"])
def test_a_level_that_others_can_write_is_not_trusted(tmp_path: Path, level: str) -> None:
    chosen()
    (tmp_path / level).chmod(0o777)
    folder, notice = chosen()
    assert folder.path == tmp_path / "first" / "jit" / FINGERPRINT
    assert notice == (
        f"{tmp_path / level} can be written by other users (mode 777): "
        f"compiled kernels are kept in {folder.path} instead"
    )


@pytest.mark.parametrize("level", ["data/jit", f"data/jit/{FINGERPRINT}"])
def test_a_link_below_the_data_folder_is_not_followed(tmp_path: Path, level: str) -> None:
    chosen()
    (tmp_path / level).rename(tmp_path / "moved")
    (tmp_path / level).symlink_to(tmp_path / "moved")
    folder, notice = chosen()
    assert folder.path.is_relative_to(tmp_path / "first")
    assert notice.startswith(f"{tmp_path / level}: ")


def test_a_data_folder_may_be_a_link(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "data").symlink_to(tmp_path / "disk")
    assert chosen()[1] == ""


def test_a_private_folder_is_judged_as_well(tmp_path: Path) -> None:
    (tmp_path / "data").touch()
    (tmp_path / "first").mkdir(mode=0o700)
    (tmp_path / "first").chmod(0o777)
    assert chosen()[0].path.is_relative_to(tmp_path / "second")


def test_a_full_disk_is_not_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    full = {tmp_path / "data"}
    monkeypatch.setattr(PrivateFolder, "free_bytes", lambda self: 0 if self.path.parents[1] in full else 1 << 30)
    folder, notice = chosen()
    assert folder.path.is_relative_to(tmp_path / "first")
    assert LITTLE in notice
    full |= {tmp_path / "first", tmp_path / "second"}
    nothing, notice = choose_kernel_folder()
    assert nothing is None
    assert (
        notice == f"{tmp_path / 'data' / 'jit' / FINGERPRINT}: {LITTLE}: every process compiles its kernels in memory"
    )


def test_only_a_complete_folder_need_not_be_writable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(PrivateFolder, "is_writable", lambda self: "data" not in self.path.parts)
    folder, notice = chosen()
    assert f"data/jit/{FINGERPRINT}: it cannot be written: compiled kernels are kept in" in notice
    data = PrivateFolder(data_folder() / "jit" / FINGERPRINT, os.open(data_folder() / "jit" / FINGERPRINT, os.O_RDONLY))
    mark_complete(data, "synthetic")
    assert chosen()[0].path == data.path != folder.path


def test_processes_of_the_service_take_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "first"))
    folder, notice = chosen()
    assert (folder.path.is_relative_to(tmp_path / "first"), notice) == (True, "")
    (tmp_path / "first").chmod(0o777)
    assert chosen()[0].path.is_relative_to(tmp_path / "data"), "a name from the environment is not trusted by itself"


def test_complete_means_every_file_is_there() -> None:
    folder, _ = chosen()
    folder.write("one", b"1")
    folder.write("two", b"2")
    assert not is_complete(folder, "synthetic")
    mark_complete(folder, "synthetic")
    folder.write("three", b"3")
    assert kernel_files(folder) == ["one", "three", "two"]
    assert is_complete(folder, "synthetic")
    assert not is_complete(folder, "camera")
    folder.delete("three")
    assert is_complete(folder, "synthetic"), "it came later"
    (folder.path / "one").write_bytes(b"damaged")
    assert not is_complete(folder, "synthetic")
    assert delete_damaged(folder) == 1
    assert delete_damaged(folder) == 0
    assert not is_complete(folder, "synthetic")
    assert kernel_files(folder) == ["two"]


def test_old_versions_are_deleted(tmp_path: Path) -> None:
    folder, _ = chosen()
    for number in range(VERSIONS_KEPT + 2):
        (tmp_path / "data" / "jit" / f"old-{number}").mkdir()
    delete_old_versions(chosen()[0])
    left = sorted(path.name for path in (tmp_path / "data" / "jit").iterdir() if path.is_dir())
    assert len(left) == VERSIONS_KEPT
    assert folder.path.name in left, "it was used last"
