"""In a checkout, the page is built beside the kernels: by an ordinary process that the service does not wait for."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import app

NICENESS = 19
"""The kernels come first."""


@contextmanager
def page_being_built() -> Iterator[None]:
    """Build the page while the block runs, where its sources are. It prints what it does."""
    assert app.__file__ is not None
    script = Path(app.__file__).parents[1] / "web" / "build.py"
    if not script.is_file():
        yield
        return
    with subprocess.Popen(
        ["nice", f"-{NICENESS}", sys.executable, str(script)], stdin=subprocess.DEVNULL, process_group=0
    ) as building:
        try:
            yield
        finally:
            building.terminate()
