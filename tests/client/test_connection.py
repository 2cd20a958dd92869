"""A client against a server that plays, and against servers that misbehave."""

import asyncio
import functools
import itertools
import logging
import math
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import pytest

from tests.client.fake import ScriptedServer
from tests.net.serving import Stadium, playing, running
from tests.protocol.samples import rules
from vision_core.client import Options, connect
from vision_core.client.connection import RESTART_S, SILENCE_S
from vision_core.client.lag import REPORT_S, TO_REPORTS
from vision_core.clock import Instant, ManualClock, seconds_between
from vision_core.errors import ConnectionRefused
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.net.delivery_rows import UNKNOWN
from vision_core.protocol.encoding import encode
from vision_core.protocol.error_codes import MEANINGS, TRANSIENT, ErrorCode
from vision_core.protocol.messages import FIXED_BY_MATCH, MirrorReply, WarningReply
from vision_core.types.objects import Team

HOST = "127.0.0.1"
ASKED = b"(init blue 3 (version 2))"
GRANTED = b"(init blue 3 play_on)"


connect_with_mirror = functools.partial(connect, mirror=PAPER_MIRROR)
"""For servers that are not to be asked for their mirror."""


def granting(*then: bytes) -> ScriptedServer:
    """A server that answers every init, and says more at once."""
    return ScriptedServer(lambda data: [GRANTED, *then] if data.startswith(b"(init") else [])


@pytest.fixture(scope="module")
def stadium() -> Iterator[Stadium]:
    with playing(Stadium()) as opened:
        yield opened


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
    with granting() as server, connect_with_mirror(HOST, server.port, "blue", 3) as robot:
        assert robot.latest() is None
        assert robot.receive(0.05) is None


def test_old_foreign_and_damaged_datagrams_are_passed_over() -> None:
    noise = [b"\xff\x00", b"(see nonsense)", b"(init yellow 3 play_on)", see(2.0), see(1.0), see(2.0), see(3.0), b"("]
    with granting(*noise) as server, connect_with_mirror(HOST, server.port, "blue", 3) as robot:
        views = [robot.receive(0.3) for _ in range(3)]
    assert [view.time_s if view else None for view in views] == [2.0, 3.0, None]


@pytest.mark.parametrize("name", sorted(set(ErrorCode) - TRANSIENT))
def test_a_refusal_is_named_and_explained(name: ErrorCode) -> None:
    refusal = b"(error %s)" % name.encode()
    with ScriptedServer(lambda _: [refusal]) as server, pytest.raises(ConnectionRefused) as refused:
        connect_with_mirror(HOST, server.port, "blue", 3)
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


def test_silence_is_explained() -> None:
    with ScriptedServer(lambda _: []) as server, pytest.raises(ConnectionRefused) as refused:
        connect_with_mirror(HOST, server.port, "blue", 3, timeout_s=0.7)
    assert f"nothing answered at 127.0.0.1:{server.port} within 0.7 s" in str(refused.value)
    assert "admission.subnets" in str(refused.value)
    assert server.heard.count(ASKED) == 2


def answering(*answers: list[bytes]) -> ScriptedServer:
    """A server with one list of answers per datagram, and the last list for all that follow."""
    left = list(answers)
    return ScriptedServer(lambda _: left.pop(0) if len(left) > 1 else left[0])


@pytest.mark.parametrize("error", sorted(TRANSIENT))
def test_an_error_that_passes_is_waited_for(error: ErrorCode) -> None:
    answers = [b"(error %s)" % error.encode()], [GRANTED]
    with answering(*answers) as server, connect_with_mirror(HOST, server.port, "blue", 3) as robot:
        assert robot.mode == "play_on"
        assert robot.last_error == ""
    assert server.heard[:2] == [ASKED] * 2


def test_a_server_that_prepares_is_waited_for_longer_than_silence(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING, "vision_core.client")
    with answering(*[[b"(error not_ready)"]] * 3, [GRANTED]) as server:
        connect_with_mirror(HOST, server.port, "blue", 3, timeout_s=0.8).close()
    (record,) = caplog.records
    assert "the server still prepares" in record.getMessage()


def test_an_error_that_does_not_pass_is_named() -> None:
    with answering([b"(error rate_limited)"]) as server, pytest.raises(ConnectionRefused) as refused:
        connect_with_mirror(HOST, server.port, "blue", 3, timeout_s=0.7)
    assert "error rate_limited for 0.7 s" in str(refused.value)


OTHER_MIRROR = Mirror(1.933098, 0.00296946, 360000.0)
TOLD = encode(MirrorReply(OTHER_MIRROR))


def test_a_real_server_tells_its_mirror(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 3) as robot:
        assert robot.mirror == PAPER_MIRROR
    with connect(HOST, stadium.port, "blue", 3, options=Options(mirror=OTHER_MIRROR)) as robot:
        assert robot.mirror == OTHER_MIRROR


def test_the_cookie_of_a_challenge_is_returned_with_the_key() -> None:
    cookie = b"0123456789abcdef01234567"
    with answering([b"(challenge %s)" % cookie], [GRANTED]) as server:
        connect_with_mirror(HOST, server.port, "blue", 3, key="Key_9").close()
    assert server.heard[:2] == [
        b"(init blue 3 (version 2) (key Key_9))",
        b"(init blue 3 (version 2) (cookie %s) (key Key_9))" % cookie,
    ]


@pytest.mark.parametrize("key", ["two words", "a)(bye", "k" * 129, "Schlüssel"])
def test_what_is_no_key_is_named_and_not_shown(key: str) -> None:
    with pytest.raises(ConnectionRefused, match="the team's key; found: .* characters") as refused:
        connect(HOST, 1, "blue", 3, key=key)
    assert key not in str(refused.value)


def test_a_server_of_version_2_tells_the_mirror_with_its_answer(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 3, options=Options(extras=("seq", "flags"))) as robot:
        assert robot.facts is not None
        assert (robot.facts.version, robot.facts.mirror, robot.facts.venue) == (2, PAPER_MIRROR, "default")


def test_the_servers_clock_is_learned_while_views_are_read(stadium: Stadium) -> None:
    with connect(HOST, stadium.port, "blue", 3) as robot:
        assert math.isnan(robot.server_time().time_s)
        views = list(itertools.islice(robot, 40))
        before = stadium.clock.now()
        time_s, bound_s = robot.server_time()
        truth_s = [seconds_between(stadium.rules.boot, now) for now in (before, stadium.clock.now())]
    assert truth_s[0] - bound_s <= time_s <= truth_s[1] + bound_s
    assert math.isnan(views[0].age_s)
    assert math.isfinite(views[-1].age_bound_s)
    assert views[-1].age_s > -views[-1].age_bound_s


def test_an_answer_waits_for_a_busy_program_without_harm(stadium: Stadium) -> None:
    """Answers arrive when the kernel stamps them: else reading every 50 ms would give a bound of 25 ms."""
    with connect(HOST, stadium.port, "blue", 3) as robot:
        for _ in range(100):
            time.sleep(0.05)
            robot.latest()
            if robot.server_time().bound_s < 0.02:
                break
        assert robot.server_time().bound_s < 0.02


def test_a_server_of_version_1_is_not_asked_for_its_clock() -> None:
    with granting(see(1.0)) as server, connect_with_mirror(HOST, server.port, "blue", 3) as robot:
        view = robot.receive(1.0)
        assert view is not None
        assert (math.isnan(view.age_s), view.age_bound_s) == (True, math.inf)
        assert robot.receive(0.1) is None
    assert not any(b"(sync" in data for data in server.heard)


def test_a_program_of_asyncio(stadium: Stadium) -> None:
    async def times() -> list[float]:
        found: list[float] = []
        async for view in robot:
            found.append(view.time_s)
            if len(found) == 3:
                break
        return found

    with connect(HOST, stadium.port, "blue", 3) as robot:
        found = asyncio.run(times())
    assert found == sorted(set(found))


def test_directions_are_those_that_a_match_grants() -> None:
    """Whatever was asked for, also when the match begins while the client is connected."""
    stadium = Stadium()
    asked = Options(fov_deg=90.0, center_deg=0.0, resolution_deg=1.0)
    with running(stadium):
        robot = connect(HOST, stadium.port, "blue", 3, options=asked)
        view = robot.receive(2.0)
        assert view is not None
        assert (len(view.px), view.directions_deg[0]) == (90, 315.0)
    fixed = Options(fov_deg=180.0, center_deg=90.0, resolution_deg=2.0)
    stadium.server.apply(replace(stadium.rules, fixed=fixed), "play_on", stadium.clock.now())
    with robot, running(stadium):
        wait_until(lambda: robot.receive(2.0) is not None and robot.options.fov_deg == 180.0)
        view = robot.receive(2.0)
        assert view is not None
        assert (len(view.px), view.directions_deg[0], view.directions_deg[1]) == (90, 0.0, 2.0)
    stadium.close()


def test_what_the_referee_says_is_noted() -> None:
    told = Mirror(4.2, 0.0131, 91000.0)
    heard = [
        b"(hear 1.0 referee kick_off_l)",
        b"(hear 1.0 referee vision_lost)",
        b"(hear 1.0 mirror 4.2 0.0131 91000.0)",
        b"(hear 1.0 announcer nonsense)",
    ]
    with answering([GRANTED, TOLD, *heard, see(1.0)]) as server, connect(HOST, server.port, "blue", 3) as robot:
        assert (robot.mode, robot.sees) == ("play_on", True)
        view = robot.receive(2.0)
        assert (robot.mode, robot.sees, robot.mirror) == ("kick_off_l", False, told)
        assert view is not None
        assert view.mm[0] == told.mm_from_px(44.5)


def test_a_server_that_asks_whether_we_live_is_answered() -> None:
    with answering([GRANTED, TOLD, b"(ping 5)", see(1.0)]) as server:
        with connect(HOST, server.port, "blue", 3) as robot:
            robot.receive(2.0)
        wait_until(lambda: b"(ping 5)" in server.heard)


def test_views_are_decoded_with_the_mirror_that_the_server_tells() -> None:
    with answering([GRANTED, TOLD, see(1.0)]) as server, connect(HOST, server.port, "blue", 3) as robot:
        view = robot.receive(1.0)
    assert server.heard[0] == ASKED + b"(mirror)"
    assert view is not None
    assert view.mm[0] == OTHER_MIRROR.mm_from_px(44.5)


def test_a_lost_answer_about_the_mirror_heals() -> None:
    other_robot = encode(MirrorReply(PAPER_MIRROR, Team.BLUE, 4))
    with answering([GRANTED, see(1.0)], [other_robot, b"(mirror 0 0 0)"], [TOLD]) as server:
        with connect(HOST, server.port, "blue", 3) as robot:
            assert robot.mirror == OTHER_MIRROR
        assert server.heard[:3] == [ASKED + b"(mirror)", b"(mirror)", b"(mirror)"]


@pytest.mark.parametrize("answers", [[[GRANTED, b"(error unknown_command)"]], [[GRANTED], []]])
def test_without_a_mirror_nothing_is_guessed(answers: list[list[bytes]]) -> None:
    """An older server does not know the question, or all answers are lost."""
    with answering(*answers) as server:
        with pytest.raises(ConnectionRefused) as refused:
            connect(HOST, server.port, "blue", 3, timeout_s=0.7)
        wait_until(lambda: server.heard[-1] == b"(bye)")
    assert "the server does not tell its mirror" in str(refused.value)
    assert "mirror=Mirror(A, B, C)" in str(refused.value)


@pytest.mark.parametrize("given", [{"mirror": OTHER_MIRROR}, {"options": Options(mirror=OTHER_MIRROR)}])
def test_a_given_mirror_is_used_without_asking(given: dict[str, Any]) -> None:
    answers = [GRANTED, encode(MirrorReply(PAPER_MIRROR)), see(1.0)]
    with answering(answers) as server, connect(HOST, server.port, "blue", 3, **given) as robot:
        assert robot.receive(1.0) is not None
        assert robot.mirror == OTHER_MIRROR
    assert not any(b"(mirror)" in data for data in server.heard)


def test_a_match_that_fixes_the_mirror_is_obeyed() -> None:
    """No view is decoded with the mirror that was asked for and not granted."""
    asked = Options(mirror=PAPER_MIRROR)
    answers = [GRANTED, encode(WarningReply(FIXED_BY_MATCH)), see(1.0)]
    with answering(answers, [TOLD, see(2.0)]) as server:
        with connect(HOST, server.port, "blue", 3, options=asked) as robot:
            view = robot.receive(3.0)
            assert view is not None
            assert (view.time_s, view.mm[0]) == (2.0, OTHER_MIRROR.mm_from_px(44.5))
        assert server.heard[1] == b"(mirror)"


def test_a_mirror_that_the_operator_changes_is_learned_with_the_next_lag_report() -> None:
    clock = ManualClock()
    lagging = [encode(MirrorReply(PAPER_MIRROR)), see(4.0)]
    with answering([GRANTED, TOLD, see(1.0), see(2.0), see(3.0)], lagging) as server:
        with connect(HOST, server.port, "blue", 3, clock=clock) as robot:
            first = robot.receive(1.0)
            for _ in range(2):
                clock.advance(0.6)
                robot.receive(1.0)
            last = robot.receive(1.0)
        assert server.heard[1].startswith(b"(lag ")
        assert server.heard[1].endswith(b"(mirror)")
    assert first is not None
    assert first.mm[0] == OTHER_MIRROR.mm_from_px(44.5)
    assert last is not None
    assert (last.time_s, last.mm[0]) == (4.0, PAPER_MIRROR.mm_from_px(44.5))


def test_a_restarted_server_may_have_another_mirror() -> None:
    """No view is decoded before the mirror is known again."""
    clock = ManualClock()
    first = [GRANTED, encode(MirrorReply(PAPER_MIRROR)), see(5.0)]
    again = [GRANTED, see(1.0), TOLD, see(2.0)]
    with answering(first, again) as server, connect(HOST, server.port, "blue", 3, clock=clock) as robot:
        before = robot.receive(1.0)
        clock.advance(RESTART_S)
        after = robot.receive(1.0)
    assert before is not None
    assert before.mm[0] == PAPER_MIRROR.mm_from_px(44.5)
    assert after is not None
    assert (after.time_s, after.mm[0]) == (2.0, OTHER_MIRROR.mm_from_px(44.5))


def test_a_restarted_server_that_does_not_tell_its_mirror_ends_the_iteration() -> None:
    clock = ManualClock()
    first = [GRANTED, TOLD]
    with answering(first, [GRANTED], []) as server, connect(HOST, server.port, "blue", 3, clock=clock) as robot:
        clock.advance(RESTART_S)
        robot.latest()
        wait_until(lambda: len(server.heard) == 2)
        wait_until(lambda: robot.latest() is None and robot._mirror is None)
        with pytest.raises(ConnectionRefused, match="does not tell its mirror"):
            robot.mirror  # noqa: B018 (reading it raises)
        clock.advance(0.9)
        robot.latest()
        wait_until(lambda: server.heard[-1] == b"(mirror)")
        for _ in range(8):
            robot._heard_at = clock.now()  # views go on
            clock.advance(0.9)
            if clock.now() > robot._mirror_due_at:
                break
            robot.latest()
        with pytest.raises(ConnectionRefused, match="does not tell its mirror"):
            robot.latest()


@pytest.mark.parametrize(("host", "port"), [("no.such.host.invalid", 6000), (HOST, 70000)])
def test_an_address_that_is_none(host: str, port: int) -> None:
    with pytest.raises(ConnectionRefused):
        connect(host, port, "blue", 3, timeout_s=0.2)


def test_our_own_mistake_raises() -> None:
    with pytest.raises(ValueError, match="pink"):
        connect(HOST, 6000, "pink", 3)


def test_a_lost_answer_heals_and_a_first_view_is_an_answer() -> None:
    answers = iter([[], [see(1.0)]])
    with (
        ScriptedServer(lambda _: next(answers, [])) as server,
        connect_with_mirror(HOST, server.port, "blue", 3) as robot,
    ):
        assert robot.mode == ""


def test_a_silent_client_keeps_its_session_alive() -> None:
    clock = ManualClock()
    with granting() as server, connect_with_mirror(HOST, server.port, "blue", 3, clock=clock) as robot:
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
            connect_with_mirror(HOST, main.port, "blue", 3, clock=clock) as robot,
        ):
            clock.advance(SILENCE_S)
            robot.latest()
            assert session.recv(100) == ASKED
            assert len(main.heard) == 1
            clock.advance(RESTART_S - SILENCE_S)
            robot.latest()
            wait_until(lambda: len(main.heard) == 2)
            assert main.heard == [ASKED] * 2


def test_reports_reach_a_real_server(stadium: Stadium, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vision_core.client.lag.REPORT_S", 0.1)
    with connect(HOST, stadium.port, "blue", 5) as robot:
        (session,) = [one for one in stadium.server.sessions if (one.team, one.number) == (Team.BLUE, 5)]
        for _ in robot:  # a report that the next view overtakes is ignored; the first one knows no use yet
            row = stadium.server.delivery(session)
            if row["client_ns"] != UNKNOWN:
                break
    assert row["network_ns"] != UNKNOWN


@pytest.mark.parametrize("error", sorted(TO_REPORTS))
def test_an_error_about_a_report_does_not_end_the_session(error: ErrorCode) -> None:
    """The server was restarted; or it is an older one, which soon hears no more reports."""
    clock, times = ManualClock(), itertools.count(1)

    def answer(data: bytes) -> list[bytes]:
        first = {b"(i": [GRANTED], b"(l": [b"(error %s)" % error.encode()]}.get(data[:2], [])
        return [*first, see(next(times))]

    with ScriptedServer(answer) as server, connect_with_mirror(HOST, server.port, "blue", 3, clock=clock) as robot:
        for _ in range(8):
            assert robot.receive(2.0) is not None
            clock.advance(max(SILENCE_S, REPORT_S))
    reports = sum(data.startswith(b"(lag ") for data in server.heard)
    assert 1 <= reports <= 3 if error == ErrorCode.UNKNOWN_COMMAND else reports >= 4


def test_a_restarted_server_is_found_again(caplog: pytest.LogCaptureFixture) -> None:
    """Time begins anew there, and views go on; the program is told."""
    stadium = Stadium()
    with running(stadium):
        robot = connect(HOST, stadium.port, "blue", 3)
        assert robot.receive(1.0) is not None
    stadium.restart(rules(boot=stadium.clock.now()))
    with robot, running(stadium):
        robot.latest()
        robot._heard_at = robot._asked_at = Instant(robot._heard_at - round(RESTART_S * 1e9))
        view = robot.receive(2.0)
        assert view is not None
        assert view.time_s < 1.0
        assert [session.number for session in stadium.server.sessions] == [3]
        assert robot.restarts == 1
    said = [record.getMessage().partition(": ")[2] for record in caplog.records]
    assert said == [
        "no answer for 3 s; asking until there is one",
        "the server answers again",
        "the server was restarted; its time begins anew",
    ]
    stadium.close()
