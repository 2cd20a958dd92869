"""The log has a line for each change of the state, and for each new cause."""

import fcntl
import os

import pytest

from app.web.health.cause import Cause, Subject
from app.web.health.log import NOT_READY_HOLD_S, HealthLog
from app.web.health.monitor import Health
from app.web.log_output import write_line
from vision_core.clock import Instant, after

START = Instant(1_000_000_000_000)
READY = Health((), ())
SLOW = Cause("rate", Subject.CAMERA, "slow", "Hurry.", "9 of 30")
OFF = Cause("off", Subject.SERVICE, "task lines is switched off", "Switch it on.")
BLIND = Health((Cause("blind", Subject.CAMERA, "no image yet", "Look."),), ())


class Log:
    """A log and the instants at which it is called."""

    def __init__(self, capfd: pytest.CaptureFixture[str]) -> None:
        self._log, self._capfd = HealthLog(), capfd

    def lines(self, health: Health, at_s: float, *, is_starting: bool = False) -> list[str]:
        """What is printed for a health at an instant [s since START]."""
        self._log.note(health, after(START, at_s), is_starting=is_starting)
        return self._capfd.readouterr().err.splitlines()


@pytest.fixture
def log(capfd: pytest.CaptureFixture[str]) -> Log:
    return Log(capfd)


def test_each_change_is_one_line(log: Log) -> None:
    assert log.lines(READY, 0.0) == ["ready"]
    assert log.lines(READY, 1.0) == []
    assert log.lines(Health((), (SLOW,)), 2.0) == ["ready but degraded: slow: 9 of 30"]
    assert log.lines(Health((), (SLOW, OFF)), 3.0) == ["degraded: task lines is switched off"]
    assert log.lines(Health((), (OFF,)), 4.0) == []
    assert log.lines(READY, 5.0) == ["ready"]


def test_a_start_is_not_called_not_ready(log: Log) -> None:
    assert log.lines(BLIND, 0.0, is_starting=True) == []
    assert log.lines(BLIND, 60.0, is_starting=True) == []
    assert log.lines(READY, 61.0) == ["ready"]


def test_a_service_that_never_gets_a_picture_is_never_called_ready(log: Log) -> None:
    assert log.lines(BLIND, 0.0, is_starting=True) == []
    assert log.lines(BLIND, 1.0) == []
    assert log.lines(BLIND, 1.0 + NOT_READY_HOLD_S) == ["not ready: no image yet"]
    assert log.lines(BLIND, 9.0) == []


def test_a_short_gap_is_no_news(log: Log) -> None:
    log.lines(READY, 0.0)
    assert log.lines(BLIND, 1.0) == []
    assert log.lines(READY, 2.0) == []


def test_a_line_that_nobody_reads_is_dropped_and_delays_nobody() -> None:
    reading, writing = os.pipe()
    fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 4096)
    assert write_line("ready", writing)
    while write_line("x" * 4000, writing):
        pass
    assert os.read(reading, 6) == b"ready\n"
    os.close(reading)
    assert not write_line("not ready", writing)
    os.close(writing)
