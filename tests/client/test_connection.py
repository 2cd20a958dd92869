"""A client against a server that plays, and against servers that misbehave."""

import itertools
import socket
import time
from collections.abc import Callable, Iterator

import pytest

from tests.client.fake import ScriptedServer
from tests.net.serving import Stadium, running
from vision_core.client import Options, connect
from vision_core.client.connection import RESTART_S, SILENCE_S
from vision_core.client.lag import REPORT_S, TO_REPORTS
from vision_core.clock import ManualClock
from vision_core.errors import ConnectionRefused
from vision_core.protocol.error_codes import MEANINGS, ErrorName
from vision_core.protocol.lifecycle import State
from vision_core.protocol.session import Sessions
from vision_core.types.objects import Team

HOST = "127.0.0.1"
GRANTED = b"(init blue 3 play_on)"


def granting(*then: bytes) -> ScriptedServer:
    """A server that answers every init, and says more at once."""
    return ScriptedServer(lambda data: [GRANTED, *then] if data.startswith(b"(init") else [])


@pytest.fixture(scope="module")
def stadium() -> Iterator[Stadium]:
    opened = Stadium()
    with running(opened):
        yield opened
    opened.close()


def see(time_s: float) -> bytes:
    return b"(see %.3f ((edge) w2c-ff) ((ball) -1 0 0))" % time_s


def wait_until(holds: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 2.0
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.005)
    assert holds()


def test_views_in_order_of_time(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 1, options=Options(types="team")) as robot:
        assert robot.mode == "play_on"
        views = list(itertools.islice(robot, 5))
    times = [view.time_s for view in views]
    assert times == sorted(set(times))
    assert set(views[0].px.tolist()) == {0x2C}
    assert len(views[0].mm) == 360
    assert abs(views[0].mm[0] - 220.0) < 8.0
    assert (views[0].ball.px, views[0].ball.direction_deg, views[0].ball.hidden) == (61, 121, False)


def test_closing_says_bye(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, Team.YELLOW, 2):
        pass
    wait_until(lambda: not [s for s in stadium.server.sessions if (s.team, s.number) == (Team.YELLOW, 2)])


def test_the_latest_view_skips_older_ones(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 2) as robot:
        first = robot.receive(1.0)
        time.sleep(0.1)
        newest = robot.latest()
        following = robot.receive(1.0)
    assert first is not None
    assert newest is not None
    assert following is not None
    assert newest.time_s - first.time_s > 0.05
    assert 0.0 < following.time_s - newest.time_s < 0.05


def test_nothing_new_is_none() -> None:
    with granting() as server, connect(HOST, server.port, "blue", 3) as robot:
        assert robot.latest() is None
        assert robot.receive(0.05) is None


def test_old_foreign_and_damaged_datagrams_are_passed_over() -> None:
    noise = [b"\xff\x00", b"(see nonsense)", b"(init yellow 3 play_on)", see(2.0), see(1.0), see(2.0), see(3.0), b"("]
    with granting(*noise) as server, connect(HOST, server.port, "blue", 3) as robot:
        views = [robot.receive(0.3) for _ in range(3)]
    assert [view.time_s if view else None for view in views] == [2.0, 3.0, None]


@pytest.mark.parametrize("name", list(ErrorName))
def test_a_refusal_is_named_and_explained(name: ErrorName) -> None:
    refusal = b"(error %s)" % name.encode()
    with ScriptedServer(lambda _: [refusal]) as server, pytest.raises(ConnectionRefused) as refused:
        connect(HOST, server.port, "blue", 3)
    assert name in str(refused.value)
    assert MEANINGS[name] in str(refused.value)


def test_a_real_servers_refusals(stadium: Stadium) -> None:
    with pytest.raises(ConnectionRefused, match="illegal_number"):
        connect(HOST, stadium.port, "blue", 6)
    with pytest.raises(ConnectionRefused, match="illegal_option"):
        connect(HOST, stadium.port, "blue", 1, options=Options(rate_hz=0))


def test_being_replaced_ends_the_iteration(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 4) as old, connect(HOST, stadium.port, "blue", 4) as new:
        with pytest.raises(ConnectionRefused, match="replaced"):
            for _ in old:
                pass
        assert new.receive(1.0) is not None


def test_nobody_there() -> None:
    with ScriptedServer(lambda _: []) as server, pytest.raises(ConnectionRefused, match=r"no answer within 0\.5 s"):
        connect(HOST, server.port, "blue", 3, timeout_s=0.5)
    assert server.heard.count(b"(init blue 3)") == 2


@pytest.mark.parametrize(("host", "port"), [("no.such.host.invalid", 6000), (HOST, 70000)])
def test_an_address_that_is_none(host: str, port: int) -> None:
    with pytest.raises(ConnectionRefused):
        connect(host, port, "blue", 3, timeout_s=0.2)


def test_our_own_mistake_raises() -> None:
    with pytest.raises(ValueError, match="pink"):
        connect(HOST, 6000, "pink", 3)


def test_a_lost_answer_heals_and_a_first_view_is_an_answer() -> None:
    answers = iter([[], [see(1.0)]])
    with ScriptedServer(lambda _: next(answers, [])) as server, connect(HOST, server.port, "blue", 3) as robot:
        assert robot.mode == ""


def test_a_silent_client_keeps_its_session_alive() -> None:
    clock = ManualClock()
    with granting() as server, connect(HOST, server.port, "blue", 3, clock=clock) as robot:
        for heard in range(2, 5):
            clock.advance(SILENCE_S)
            robot.latest()
            wait_until(lambda heard=heard: len(server.heard) == heard)  # type: ignore[misc]


def test_silence_is_asked_about_at_the_session_port_and_then_at_the_main_port() -> None:
    clock = ManualClock()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as session:
        session.bind((HOST, 0))
        session.settimeout(2.0)
        with (
            ScriptedServer(lambda _: [GRANTED], session) as main,
            connect(HOST, main.port, "blue", 3, clock=clock) as robot,
        ):
            clock.advance(SILENCE_S)
            robot.latest()
            assert session.recv(100) == b"(init blue 3)"
            assert len(main.heard) == 1
            clock.advance(RESTART_S - SILENCE_S)
            robot.latest()
            wait_until(lambda: len(main.heard) == 2)
            assert main.heard == [b"(init blue 3)"] * 2


def test_reports_reach_a_real_server(stadium: Stadium, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vision_core.client.lag.REPORT_S", 0.1)
    with connect(HOST, stadium.port, "blue", 5) as robot:
        (session,) = [one for one in stadium.server.sessions if (one.team, one.number) == (Team.BLUE, 5)]
        for _ in robot:  # a report that the next view overtakes is passed over; the first one knows no use yet
            if session.client_s is not None:
                break
    assert session.network_s is not None


@pytest.mark.parametrize("error", sorted(TO_REPORTS))
def test_an_error_about_a_report_does_not_end_the_session(error: ErrorName) -> None:
    """The server was restarted; or it is an older one, which soon hears no more reports."""
    clock, times = ManualClock(), itertools.count(1)

    def answer(data: bytes) -> list[bytes]:
        first = {b"(i": [GRANTED], b"(l": [b"(error %s)" % error.encode()]}.get(data[:2], [])
        return [*first, see(next(times))]

    with ScriptedServer(answer) as server, connect(HOST, server.port, "blue", 3, clock=clock) as robot:
        for _ in range(8):
            assert robot.receive(2.0) is not None
            clock.advance(max(SILENCE_S, REPORT_S))
    reports = sum(data.startswith(b"(lag ") for data in server.heard)
    assert 1 <= reports <= 3 if error == ErrorName.UNKNOWN_COMMAND else reports >= 4


def test_a_restarted_server_is_found_again() -> None:
    """Time begins anew there, and views go on."""
    stadium = Stadium()
    with running(stadium):
        robot = connect(HOST, stadium.port, "blue", 3)
        assert robot.receive(1.0) is not None
    stadium.server.close()
    stadium.rules = Stadium.rules_of(stadium.clock.now())
    stadium.start(Sessions(stadium.rules))
    with robot, running(stadium):
        robot.latest()
        robot._heard = robot._asked = type(robot._heard)(robot._heard - round(RESTART_S * 1e9))
        view = robot.receive(2.0)
        assert view is not None
        assert view.time_s < 1.0
        assert [session.state for session in stadium.server.sessions] == [State.TRYING]
    stadium.close()
