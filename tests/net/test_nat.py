"""Clients behind an address translation, which lets nothing in from the session port."""

from collections.abc import Iterator

import pytest

from tests.net.nat import Nat
from tests.net.serving import Stadium, running
from vision_core.client import connect
from vision_core.clock import MonotonicClock
from vision_core.examination.before_match import Asked, check_server
from vision_core.examination.findings import Grade
from vision_core.types.objects import Team

PATIENCE_S = 10.0


@pytest.fixture
def stadium() -> Iterator[Stadium]:
    opened = Stadium()
    opened.send_frame()  # compiles
    with running(opened):
        yield opened
    opened.close()


@pytest.fixture
def nat(stadium: Stadium) -> Iterator[Nat]:
    with Nat(("127.0.0.1", stadium.port)) as between:
        yield between


def test_a_client_behind_it_is_served_from_the_main_port(nat: Nat) -> None:
    with connect("127.0.0.1", nat.port, "blue", 3, timeout_s=PATIENCE_S) as robot:
        assert robot.port == nat.port
        times = [view.time_s for view, _ in zip(robot, range(10), strict=False)]
    assert times == sorted(set(times))


def test_two_clients_behind_it_are_two(nat: Nat, stadium: Stadium) -> None:
    with (
        connect("127.0.0.1", nat.port, "blue", 3, timeout_s=PATIENCE_S) as one,
        connect("127.0.0.1", nat.port, "blue", 4, timeout_s=PATIENCE_S) as other,
    ):
        assert one.receive(PATIENCE_S) is not None
        assert other.receive(PATIENCE_S) is not None
        assert len({session.peer for session in stadium.server.sessions}) == 2


def test_a_client_whose_outer_address_changes_goes_on(nat: Nat) -> None:
    with connect("127.0.0.1", nat.port, "blue", 3, timeout_s=PATIENCE_S) as robot:
        before = robot.receive(PATIENCE_S)
        nat.forget()
        after = robot.receive(PATIENCE_S)
        assert before is not None
        assert after is not None
        assert after.time_s > before.time_s


def test_the_check_before_a_match_says_so(nat: Nat) -> None:
    asked = Asked("127.0.0.1", nat.port, Team.BLUE, 3)
    found = {one.name: one for one in check_server(asked, MonotonicClock(), seconds=0.5, timeout_s=PATIENCE_S)}
    assert found["port"].grade is Grade.DOUBTFUL
    assert "an address translation is in between" in found["port"].sentence
