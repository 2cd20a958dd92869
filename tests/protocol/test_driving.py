"""Commands for robots: read, refused by name, counted apart from other commands."""

import math
from dataclasses import replace

import pytest

from tests.protocol.samples import OTHER, Server, replies, rules
from vision_core.protocol.answers import decode_message
from vision_core.protocol.commands import decode_commands
from vision_core.protocol.driving import Drive, DriveLimits
from vision_core.protocol.encoding import encode
from vision_core.protocol.events import Driven
from vision_core.protocol.messages import InitReply
from vision_core.protocol.rate_limits import DRIVE_RATE
from vision_core.types.objects import Team

OMNI = DriveLimits(2.0, 2.0, 10.0, 5.0, dribbler=True)
TWO_WHEELS = DriveLimits(1.5, 0.0, 15.0, 0.0, dribbler=False)


def venue(limits: DriveLimits = OMNI) -> Server:
    """A simulated venue in which blue 1..3 can be driven, with a session of blue 3."""
    server = Server()
    server.apply(replace(rules(), drives={(Team.BLUE, number): limits for number in (1, 2, 3)}))
    server.hear(b"(init blue 3)")
    return server


def driven(server: Server, datagram: bytes) -> list[Drive]:
    return [event.drive for event in server.hear(datagram) if isinstance(event, Driven)]


@pytest.mark.parametrize(
    "drive",
    [
        Drive(),
        Drive(0.5, -0.25, 3.125),
        Drive(0.5, 0.0, 0.0, 4.5),
        Drive(-1.0, 0.0, 0.0, dribble=True),
        Drive(1.0, 0.0, 0.0, 1.0, dribble=True, team=Team.YELLOW, number=4),
    ],
)
def test_a_command_survives_the_wire(drive: Drive) -> None:
    request = decode_commands(encode(drive))
    assert request is not None
    assert request.commands == (drive,)


def test_a_command_is_taken_without_an_answer() -> None:
    server = venue()
    expected = Drive(0.5, 0.0, -1.0, 3.0, dribble=True)
    assert driven(server, b"(drive 0.5 0 -1 (dribble) (kick 3))") == [expected]
    assert driven(server, b"(DRIVE blue 3 .5 0 -1 (kick 3)(dribble))") == [replace(expected, team=Team.BLUE, number=3)]
    assert server.answers(b"(drive 0 0 0)") == []


@pytest.mark.parametrize(
    "form",
    [
        b"(drive)",
        b"(drive 1 2)",
        b"(drive 1 2 3 4)",
        b"(drive nan 0 0)",
        b"(drive 0 inf 0)",
        b"(drive 0 0 fast)",
        b"(drive 0 0 0 (kick))",
        b"(drive 0 0 0 (kick nan))",
        b"(drive 0 0 0 (kick 1) (kick 2))",
        b"(drive 0 0 0 (dribble 1))",
        b"(drive 0 0 0 (jump))",
        b"(drive 0 0 0 ())",
        b"(drive (1) 0 0)",
        b"(drive 0 0 (dribble) 0)",
    ],
)
def test_a_malformed_command_is_an_illegal_form(form: bytes) -> None:
    server = venue()
    assert driven(server, form) == []
    server.clock.advance(10.0)
    assert server.answers(form) == [b"(error illegal_form)"]


@pytest.mark.parametrize(
    ("limits", "form"),
    [
        (OMNI, b"(drive 2.1 0 0)"),
        (OMNI, b"(drive 1.5 1.5 0)"),
        (OMNI, b"(drive 0 0 -11)"),
        (OMNI, b"(drive 1e999 0 0)"),
        (OMNI, b"(drive 0 0 0 (kick 6))"),
        (OMNI, b"(drive 0 0 0 (kick -1))"),
        (TWO_WHEELS, b"(drive 0 0.1 0)"),
        (TWO_WHEELS, b"(drive 0 0 0 (kick 1))"),
        (TWO_WHEELS, b"(drive 0 0 0 (dribble))"),
    ],
)
def test_what_the_robot_cannot_do_is_refused_once_in_five_seconds(limits: DriveLimits, form: bytes) -> None:
    server = venue(limits)
    assert server.answers(form) == [b"(error illegal_drive)"]
    assert server.hear(form) == []


@pytest.mark.parametrize(
    ("form", "error"),
    [
        (b"(drive blue 1 1 0 0)", b"(error not_connected)"),
        (b"(drive green 3 1 0 0)", b"(error illegal_team)"),
        (b"(drive blue 17 1 0 0)", b"(error illegal_number)"),
    ],
)
def test_nobody_drives_the_robot_of_somebody_else(form: bytes, error: bytes) -> None:
    assert venue().answers(form) == [error]


def test_a_stranger_drives_nothing() -> None:
    server = venue()
    assert not any(isinstance(event, Driven) for event in server.hear(b"(drive 1 0 0)", OTHER))


@pytest.mark.parametrize("number", [3, 4])
def test_a_robot_that_is_not_simulated_cannot_be_driven(number: int) -> None:
    server = Server() if number == 3 else venue()
    server.hear(b"(bye)")
    server.hear(b"(init blue %d)" % number)
    assert server.answers(b"(drive 0 0 0)") == [b"(error no_drive)"]


def test_of_several_robots_of_a_socket_one_must_be_named() -> None:
    server = venue()
    server.hear(b"(init blue 1)")
    assert server.answers(b"(drive 1 0 0)") == [b"(error illegal_form)"]
    events = server.hear(b"(drive blue 1 1 0 0)(drive blue 3 0 1 0)")
    assert [(event.session.number, event.drive.vx_m_s) for event in events if isinstance(event, Driven)] == [
        (1, 1.0),
        (3, 0.0),
    ]


def test_commands_have_a_budget_of_their_own() -> None:
    server = venue()
    taken = sum(len(driven(server, b"(drive 0 0 0)")) for _ in range(200))
    assert taken == DRIVE_RATE.burst
    assert server.answers(b"(mirror)")[0].startswith(b"(mirror ")


def test_version_2_is_told_what_its_robot_can_do() -> None:
    server = Server()
    server.apply(replace(rules(), drives={(Team.BLUE, 3): TWO_WHEELS}))
    for number, expected in ((3, TWO_WHEELS), (4, None)):
        (granted,) = replies(server.open_2(b"(init blue %d)" % number))
        reply = decode_message(granted)
        assert isinstance(reply, InitReply)
        assert reply.facts is not None
        assert reply.facts.drive == expected


@pytest.mark.parametrize("limits", [OMNI, TWO_WHEELS])
def test_what_is_clipped_is_allowed_and_in_the_same_direction(limits: DriveLimits) -> None:
    asked = Drive(9.0, 3.0, -99.0, 50.0, dribble=True)
    clipped = limits.clipped(asked)
    assert not limits.allow(asked)
    assert limits.allow(clipped)
    assert clipped.vx_m_s * limits.vy_m_s == pytest.approx(clipped.vy_m_s * 3.0 * limits.vy_m_s)
    assert not limits.allow(limits.clipped(Drive(math.nan)))
