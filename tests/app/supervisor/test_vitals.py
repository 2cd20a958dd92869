"""What the kernel tells of a process with an overdue heartbeat: stopped, asleep, or computing for too long."""

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


def test_a_process_that_sleeps_is_hung_after_a_while(sleeper: int) -> None:
    silence = silence_of(sleeper, 0)
    assert not silence.is_hung(sleeper, SOON, MAX_S)
    assert silence.is_hung(sleeper, LATER, MAX_S)


def test_a_stopped_process_is_hung_at_once(sleeper: int) -> None:
    os.kill(sleeper, signal.SIGSTOP)
    until_in(sleeper, "T")
    assert silence_of(sleeper, 0).is_hung(sleeper, SOON, MAX_S)


def test_a_process_that_computes_is_hung_when_it_has_used_its_processor_time() -> None:
    with subprocess.Popen([sys.executable, "-c", BUSY]) as process:
        until_in(process.pid, "R")
        silence = silence_of(process.pid, 0)
        assert not silence.is_hung(process.pid, 100 * LATER, MAX_S + PATIENCE_S)
        deadline = time.monotonic() + PATIENCE_S
        while not silence.is_hung(process.pid, SOON, MAX_S):
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.kill()


def test_a_process_that_has_ended_has_no_states() -> None:
    with subprocess.Popen(["true"]) as process:
        process.wait()
        assert thread_states(process.pid) == set()
