"""The log of the service: news is told when somebody can hear it, and nobody waits for a reader."""

import contextlib
import os
import sys

import pytest

from app.commands.serve import _log


@pytest.mark.timeout(20)
def test_news_is_dropped_while_the_log_is_full(monkeypatch: pytest.MonkeyPatch) -> None:
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writing, bytes(65536))
    os.set_blocking(writing, True)
    with os.fdopen(writing, "w") as log:
        monkeypatch.setattr(sys, "stderr", log)
        _log("web runs again")
        os.set_blocking(reading, False)
        with contextlib.suppress(BlockingIOError):
            while os.read(reading, 65536):
                continue
        _log("serve runs again")
        assert os.read(reading, 65536) == b"serve runs again\n"
    os.close(reading)
