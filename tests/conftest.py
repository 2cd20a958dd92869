"""Shared by all tests: compiled kernels are kept between runs, state is not."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
os.environ["PSLV_DATA_DIR"] = str(ROOT / ".pslv")  # before anything imports a kernel
for name in [name for name in os.environ if name.startswith("PSLV_") and name != "PSLV_DATA_DIR"]:
    del os.environ[name]


@pytest.fixture(scope="session")
def real_pictures() -> Path:
    """The folder of real overhead pictures beside the project; skips where it is absent."""
    folder = ROOT.parent / "shared" / "data" / "real"
    if not folder.is_dir():
        pytest.skip("no real pictures beside the project")
    return folder
