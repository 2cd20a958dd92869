"""What the service finds or makes before it starts."""

import os
import stat
from pathlib import Path

import pytest

from app.launch import plan
from app.launch.plan import prepare_kernel_folder
from vision_core.errors import ServiceError
from vision_core.native import kernel_folder
from vision_core.native.kernel_folder import VARIABLE


@pytest.fixture(autouse=True)
def _own_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_folder, "kernel_fingerprint", lambda _hashes: "0" * 16)
    monkeypatch.setattr(kernel_folder, "_private_roots", lambda: iter([tmp_path / "private"]))
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "a" / "data"))
    monkeypatch.setenv(VARIABLE, "")


def test_the_data_folder_is_made(tmp_path: Path) -> None:
    assert prepare_kernel_folder() == prepare_kernel_folder() == ()
    assert stat.S_IMODE((tmp_path / "a" / "data").stat().st_mode) == 0o700
    assert not os.environ[VARIABLE]


@pytest.mark.parametrize("in_the_way", ["a/data", "a/data/jit"])
def test_the_service_starts_without_a_data_folder(tmp_path: Path, in_the_way: str) -> None:
    (tmp_path / in_the_way).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / in_the_way).touch()
    (line,) = prepare_kernel_folder()
    assert str(tmp_path / in_the_way) in line
    assert f"kept in {tmp_path / 'private' / 'jit'}" in line
    assert os.environ[VARIABLE] == str(tmp_path / "private")
    assert prepare_kernel_folder() == (), "processes of the service take the same folder without a word"


def test_damaged_files_are_said_once(tmp_path: Path) -> None:
    prepare_kernel_folder()
    file = tmp_path / "a" / "data" / "jit" / ("0" * 16) / "kernel"
    file.write_bytes(b"cut")
    (line,) = prepare_kernel_folder()
    assert "damaged files are deleted" in line
    assert not file.exists()
    assert prepare_kernel_folder() == ()


def test_no_folder_at_all_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").touch()
    monkeypatch.setattr(kernel_folder, "_private_roots", lambda: iter([tmp_path / "a" / "private"]))
    with pytest.raises(ServiceError, match=f"{tmp_path / 'a'}.*accepted: PSLV_DATA_DIR names"):
        plan.prepare_kernel_folder()
