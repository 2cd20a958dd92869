"""Shared by all tests: compiled kernels are kept between runs, state is not."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import hypothesis
import pytest

hypothesis.settings.register_profile("untimed", deadline=None)  # a loaded machine is no fault of the code
hypothesis.settings.register_profile(
    "long", deadline=None, max_examples=10_000
)  # pytest --hypothesis-profile long --timeout 0
hypothesis.settings.load_profile("untimed")
ROOT = Path(__file__).resolve().parents[1]
os.environ["PSLV_DATA_DIR"] = str(ROOT / ".pslv")  # before anything imports a kernel
for name in [name for name in os.environ if name.startswith("PSLV_") and name != "PSLV_DATA_DIR"]:
    del os.environ[name]
os.environ["PSLV_DATABASE"] = tempfile.mkdtemp(prefix="pslv-tests-")  # what is changed on a page is not kept


SERVICES = "tests/faults", "tests/browser", "tests/app/supervisor"
"""They run a whole service or a browser, which nothing should disturb: `make test` runs them one after the other."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that run a whole service or a browser, before tests are selected by their marks."""
    for item in items:
        if item.path.relative_to(ROOT).as_posix().startswith(SERVICES):
            item.add_marker("service")


@pytest.fixture(scope="session")
def built_page() -> None:
    """Builds the page unless it is fresh; skips where its libraries cannot be had."""
    done = subprocess.run([sys.executable, ROOT / "web" / "build.py"], capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(done.stderr.strip())


@pytest.fixture(scope="session")
def real_pictures() -> Path:
    """The folder of real overhead pictures beside the project; skips where it is absent."""
    folder = ROOT.parent / "shared" / "data" / "real"
    if not folder.is_dir():
        pytest.skip("no real pictures beside the project")
    return folder
