"""What is refused before anything is started."""

from pathlib import Path

import pytest

from app.launch.plan import prepare_kernel_folder
from vision_core.errors import ServiceError


@pytest.mark.parametrize("in_the_way", ["data", "data/jit"])
def test_a_data_folder_that_cannot_be_made_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, in_the_way: str
) -> None:
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "data"))
    (tmp_path / in_the_way).parent.mkdir(exist_ok=True)
    (tmp_path / in_the_way).touch()
    with pytest.raises(ServiceError, match=f"{tmp_path / 'data'}.*PSLV_DATA_DIR names another"):
        prepare_kernel_folder()


def test_a_data_folder_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "a" / "b"))
    prepare_kernel_folder()
    prepare_kernel_folder()
    assert (tmp_path / "a" / "b").is_dir()
