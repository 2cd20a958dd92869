"""Shared by all tests: compiled kernels are kept between runs, state is not."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import hypothesis
import pytest

LONG_RUN = 500
"""Tests."""
hypothesis.settings.register_profile("untimed", deadline=None)  # a loaded machine is no fault of the code
hypothesis.settings.load_profile("untimed")
ROOT = Path(__file__).resolve().parents[1]
os.environ["PSLV_DATA_DIR"] = str(ROOT / ".pslv")  # before anything imports a kernel
for name in [name for name in os.environ if name.startswith("PSLV_") and name != "PSLV_DATA_DIR"]:
    del os.environ[name]
os.environ["PSLV_DATABASE"] = tempfile.mkdtemp(prefix="pslv-tests-")  # what is changed on a page is not kept


@pytest.fixture(scope="session", autouse=True)
def compiling(request: pytest.FixtureRequest) -> Iterator[None]:
    """Compiles the service's kernels beside the first tests of a long run, once; a short run compiles what it uses."""
    if request.session.testscollected < LONG_RUN or os.environ.get("PYTEST_XDIST_WORKER", "gw0") != "gw0":
        yield
        return
    command = [sys.executable, "-m", "app.main", "compile"]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.DEVNULL) as compiler:
        os.setpriority(os.PRIO_PROCESS, compiler.pid, 19)
        yield
        compiler.kill()


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
