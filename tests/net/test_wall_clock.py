"""The time of day is stepped while the server runs: Time goes on, and so does the clock that clients are told."""

import socket
import time
from collections.abc import Iterator

import pytest

from tests.net.serving import Stadium, robot
from vision_core.arrival_stamps import SO_TIMESTAMPNS, TIMESPEC, age_ns
from vision_core.clock import NS_PER_S
from vision_core.protocol.answers import decode_message
from vision_core.protocol.messages import See, SyncReply

REAL_TIME_NS = time.time_ns
STEPS_S = [3600.0, -3600.0, -1.0, 86400.0 * 365, -86400.0 * 365]


@pytest.fixture
def stadium() -> Iterator[Stadium]:
    opened = Stadium()
    yield opened
    opened.close()


def step(monkeypatch: pytest.MonkeyPatch, step_s: float) -> None:
    """The kernel has stamped what arrived with the time of day before the step."""
    monkeypatch.setattr("vision_core.arrival_stamps.time.time_ns", lambda: REAL_TIME_NS() + round(step_s * NS_PER_S))


@pytest.mark.parametrize("step_s", STEPS_S)
def test_a_stamp_of_before_the_step_is_not_believed(step_s: float, monkeypatch: pytest.MonkeyPatch) -> None:
    stamp = TIMESPEC.pack(*divmod(REAL_TIME_NS(), NS_PER_S))
    step(monkeypatch, step_s)
    assert age_ns([(socket.SOL_SOCKET, SO_TIMESTAMPNS, stamp)]) == 0


@pytest.mark.parametrize("step_s", STEPS_S)
def test_time_and_the_clock_go_on(step_s: float, stadium: Stadium, monkeypatch: pytest.MonkeyPatch) -> None:
    with robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        _, server = client.recvfrom(2048)
        told = []
        for number in range(4):
            if number == 2:
                step(monkeypatch, step_s)
            stadium.send_frame()
            client.sendto(b"(sync %d 5)" % number, server)
            stadium.serve()
            told += [decode_message(client.recv(2048)) for _ in range(2)]
    times = [see.time_us for see in told if isinstance(see, See)]
    answers = [reply for reply in told if isinstance(reply, SyncReply)]
    assert (len(times), len(answers)) == (4, 4)
    assert times == sorted(set(times))
    clock = [ns for reply in answers for ns in (reply.t2_ns, reply.t3_ns)]
    assert clock == sorted(clock)
