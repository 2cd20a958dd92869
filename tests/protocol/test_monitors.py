"""Monitors: who is sent the whole field, and what it says."""

import math
from dataclasses import replace

import pytest

from tests.protocol.samples import BOOT, CLIENT, MAIN, OTHER, STRANGER, Server, replies, rules
from vision_core.clock import NS_PER_S, Instant, after
from vision_core.protocol.answers import decode_message
from vision_core.protocol.commands import decode_commands
from vision_core.protocol.lifecycle import Peer
from vision_core.protocol.messages import MonitorReply, Show, ShownBall, ShownObstacle, ShownRobot
from vision_core.protocol.monitors import MAX_MONITORS
from vision_core.protocol.options import Options
from vision_core.protocol.proofs import key_digest
from vision_core.protocol.rules import VERSION_2_LEASE_S
from vision_core.protocol.session import Sessions
from vision_core.protocol.show import MAX_SHOW, encode_show
from vision_core.types.objects import Team
from vision_core.types.tracks import BallTrack, ObstacleTrack, RobotTrack, World

KEY = "monitors-key-" + "k" * 30
MATCH = replace(rules(), fixed=Options(), monitor_key=key_digest(KEY))
KEYED = b"(dispinit (key %s))" % KEY.encode()


def open_monitor(server: Server, request: bytes = b"(dispinit)", peer: Peer = CLIENT) -> list[bytes]:
    """Ask, and again with the cookie."""
    (challenge,) = server.answers(request, peer)
    return server.answers(request[:-1] + b" (cookie %s))" % challenge[len("(challenge ") : -1], peer)


def test_a_monitor_is_told_its_facts_after_it_has_proven_its_address() -> None:
    server = Server()
    (granted,) = open_monitor(server)
    reply = decode_message(granted)
    assert isinstance(reply, MonitorReply)
    assert reply.facts is not None
    assert (reply.mode, reply.facts.boot, reply.facts.venue) == ("play_on", f"{BOOT:x}", "default")
    assert [monitor.peer for monitor in server.sessions.monitors] == [CLIENT]
    assert len(server.sessions) == 0


def test_in_a_match_it_needs_the_key() -> None:
    server = Server()
    open_monitor(server, peer=OTHER)
    assert replies(server.apply(MATCH)) == [b"(error not_admitted)"]
    assert open_monitor(server) == [b"(error not_admitted)"]
    assert open_monitor(server, KEYED.replace(b"monitors", b"othermon")) == [b"(error wrong_key)"]
    assert not server.sessions.monitors
    (granted,) = open_monitor(server, KEYED)
    assert granted.startswith(b"(dispinit play_on (version 2) ")
    assert replies(server.apply(replace(MATCH, monitor_key=None))) == [b"(error not_admitted)"]


def test_with_the_key_it_may_be_anywhere() -> None:
    server = Server()
    server.apply(MATCH)
    (granted,) = open_monitor(server, KEYED, STRANGER)
    assert granted.startswith(b"(dispinit")
    assert server.answers(b"(ping 3)", STRANGER) == [b"(pong 3)"]


def test_a_teams_key_shows_nobody_the_field() -> None:
    server = Server()
    server.apply(replace(MATCH, keys={Team.BLUE: key_digest(KEY)}, monitor_key=None))
    assert open_monitor(server, KEYED) == [b"(error wrong_key)"]


def test_it_lives_on_pings_and_hears_the_referee() -> None:
    server = Server()
    open_monitor(server)
    server.clock.advance(VERSION_2_LEASE_S - 1.0)
    assert server.answers(b"(ping)") == [b"(pong)"]
    server.clock.advance(VERSION_2_LEASE_S - 1.0)
    server.sessions.expire(server.clock.now())
    assert replies(server.apply(server.sessions.rules, "pause")) == [b"(hear 28.000 referee pause)"]
    server.clock.advance(2.0)
    server.sessions.expire(server.clock.now())
    assert not server.sessions.monitors


def test_bye_ends_it() -> None:
    server = Server()
    open_monitor(server)
    assert server.answers(b"(bye)") == []
    assert not server.sessions.monitors


def test_a_place_is_free_for_a_few_only() -> None:
    server = Server()
    for port in range(MAX_MONITORS):
        open_monitor(server, peer=Peer("127.0.0.1", 50000 + port))
    assert open_monitor(server) == [b"(error server_full)"]
    (granted,) = open_monitor(server, peer=Peer("127.0.0.1", 50000))
    assert granted.startswith(b"(dispinit")


def test_a_restarted_server_goes_on_with_it() -> None:
    server = Server()
    open_monitor(server)
    restored = Sessions.restore(server.sessions.rules, server.sessions.snapshot())
    assert restored.monitors.to_plain() == server.sessions.monitors.to_plain()
    assert restored.monitors.get(CLIENT) is not None


@pytest.mark.parametrize("datagram", [b"(dispinit play_on (version 2))", b"(show 1.0)"])
def test_a_servers_own_words_get_no_answer(datagram: bytes) -> None:
    assert decode_commands(datagram) is None


def robot(team: Team, number: int | None, heading_rad: float, x_m: float = 0.1) -> RobotTrack:
    return RobotTrack(team, number, x_m, -0.25, heading_rad, 1.0, 0.5, 0.0, 0.001, 0.01, 1.0, BOOT)


def test_the_field_comes_back_as_it_was_sent() -> None:
    at = after(BOOT, 20.5)
    world = World(
        7,
        at,
        (robot(Team.BLUE, 4, math.pi / 2), robot(Team.YELLOW, None, math.nan)),
        BallTrack(1.0, 2.0, -0.5, 0.0, 0.01, False, at),
        (ObstacleTrack(-1.0, 0.5, 0.0, 0.0, 0.09, at),),
    )
    datagram = encode_show(world, BOOT, {(Team.BLUE, 4): 3})
    assert datagram == (
        b"(show 20.500 ((ball) 1000 2000 -500 0) ((robot blue 3) 100 -250 90.0 1000 500)"
        b" ((robot yellow) 100 -250 - 1000 500) ((obstacle) -1000 500 90))"
    )
    assert decode_message(datagram) == Show(
        20_500_000,
        ShownBall(1000, 2000, -500, 0),
        (ShownRobot(Team.BLUE, 3, 100, -250, 90, 1000, 500), ShownRobot(Team.YELLOW, None, 100, -250, None, 1000, 500)),
        (ShownObstacle(-1000, 500, 90),),
    )


def test_what_does_not_fit_is_left_out_obstacles_first() -> None:
    robots = tuple(robot(Team.BLUE, index, 1.0, x_m=-1.234) for index in range(32))
    obstacles = tuple(ObstacleTrack(-1.0, 0.5, 0.0, 0.0, 0.09, BOOT) for _ in range(20))
    for count in range(len(robots)):
        world = World(7, Instant(BOOT + NS_PER_S), robots[:count], None, obstacles)
        datagram = encode_show(world, BOOT, {})
        shown = decode_message(datagram)
        assert isinstance(shown, Show)
        assert len(datagram) <= MAX_SHOW
        assert len(shown.robots) == count or not shown.obstacles
    assert len(datagram) > MAX_SHOW - 60


def test_where_it_asked_it_is_answered() -> None:
    server = Server()
    open_monitor(server)
    (monitor,) = server.sessions.monitors
    assert monitor.endpoint == MAIN
