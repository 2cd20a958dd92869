"""The log of the service: news is told when somebody can hear it, and nobody waits for a reader."""

import os
import sys
from collections.abc import Iterator

import pytest

from app.commands.serve import _tell


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A log whose reader does not read: a full pipe in place of standard error."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    try:
        while True:
            os.write(writing, bytes(65536))
    except BlockingIOError:
        os.set_blocking(writing, True)
    with os.fdopen(writing, "w") as log:
        monkeypatch.setattr(sys, "stderr", log)
        yield reading
        os.close(reading)


@pytest.mark.timeout(20)
def test_news_is_dropped_when_the_log_is_full(full: int) -> None:
    _tell("web runs again")
    os.read(full, 1 << 20)
    _tell("serve runs again")
    assert os.read(full, 1 << 20) == b"serve runs again\n"
