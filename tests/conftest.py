"""Shared by all tests: compiled kernels are kept between runs, state is not."""

import os
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


@pytest.fixture(scope="session", autouse=True)
def compiling(request: pytest.FixtureRequest) -> Iterator[None]:
    """Compiles the service's kernels beside the first tests of a long run; a short run compiles what it uses."""
    from vision_core.native.kernel_cache import kernel_folder
    from vision_core.startup.compile import STEPS, started
    from vision_core.venues.loader import load_settings

    folder = kernel_folder()
    folder.mkdir(parents=True, exist_ok=True)
    short = request.session.testscollected < LONG_RUN
    processes = [] if short or list(folder.glob("complete-*")) else [started(step, load_settings()) for step in STEPS]
    for process in processes:
        os.setpriority(os.PRIO_PROCESS, process.pid, 19)
    yield
    for process in processes:
        process.kill()
        process.wait()


@pytest.fixture(scope="session")
def real_pictures() -> Path:
    """The folder of real overhead pictures beside the project; skips where it is absent."""
    folder = ROOT.parent / "shared" / "data" / "real"
    if not folder.is_dir():
        pytest.skip("no real pictures beside the project")
    return folder
