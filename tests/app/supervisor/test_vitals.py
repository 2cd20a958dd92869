"""What the kernel tells of a silent process: stopped, asleep, or computing for too long."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from app.supervisor.vitals import ASLEEP_S, silence_of, thread_states
from vision_core.clock import NS_PER_S

BUSY = "while True: pass"
MAX_S = 0.2
SOON, LATER = NS_PER_S // 100, round((ASLEEP_S + 0.1) * NS_PER_S)
PATIENCE_S = 20.0


@pytest.fixture
def sleeper() -> Iterator[int]:
    with subprocess.Popen(["sleep", "60"]) as process:
        until_in(process.pid, "S")
        yield process.pid
        process.kill()


def until_in(pid: int, state: str) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while thread_states(pid) != {state}:
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_who_sleeps_on_hangs_and_who_sleeps_for_a_moment_does_not(sleeper: int) -> None:
    silence = silence_of(sleeper, 0)
    assert not silence.is_hung(sleeper, SOON, MAX_S)
    assert silence.is_hung(sleeper, LATER, MAX_S)


def test_who_is_stopped_hangs_at_once(sleeper: int) -> None:
    os.kill(sleeper, signal.SIGSTOP)
    until_in(sleeper, "T")
    assert silence_of(sleeper, 0).is_hung(sleeper, SOON, MAX_S)


def test_who_computes_hangs_when_it_has_had_its_time_of_the_processor() -> None:
    with subprocess.Popen([sys.executable, "-c", BUSY]) as process:
        until_in(process.pid, "R")
        silence = silence_of(process.pid, 0)
        assert not silence.is_hung(process.pid, 100 * LATER, MAX_S + PATIENCE_S)
        deadline = time.monotonic() + PATIENCE_S
        while not silence.is_hung(process.pid, SOON, MAX_S):
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.kill()


def test_of_who_has_ended_nothing_is_known() -> None:
    with subprocess.Popen(["true"]) as process:
        process.wait()
        assert thread_states(process.pid) == set()
