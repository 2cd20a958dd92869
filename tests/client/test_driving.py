"""A client drives its robot: against a server, and on paper."""

import math
from collections.abc import Iterator

import pytest

from tests.client.arena import LIMITS, Arena
from tests.client.fake import ScriptedServer
from tests.net.serving import playing
from vision_core.client import Drive, DriveLimits, Robot, connect
from vision_core.errors import ConnectionRefused
from vision_core.types.objects import Team

HOST = "127.0.0.1"
MIRROR = b"(mirror 4.0187 0.0125935 90000.0)"


@pytest.fixture
def arena() -> Iterator[Arena]:
    with playing(Arena()) as opened:
        yield opened


def test_the_server_hears_what_the_robot_is_told(arena: Arena) -> None:
    with connect(HOST, arena.port, "blue", 3) as robot:
        assert robot.limits == LIMITS
        robot.drive(0.5, -0.25, 1.5)
        robot.drive(0.0, 0.0, 0.0, kick=3.0, dribble=True)
        robot.follow(Drive(5.0, 0.0, 99.0))
        for _ in range(3):
            assert robot.receive(1.0) is not None  # what was sent before is heard before bye
    expected = [Drive(0.5, -0.25, 1.5), Drive(kick_m_s=3.0, dribble=True), Drive(2.0, 0.0, 10.0)]
    assert [event.drive for event in arena.driven] == expected


@pytest.mark.parametrize("wrong", [(math.nan, 0.0, 0.0), (2.5, 0.0, 0.0), (0.0, 0.0, -11.0)])
def test_what_the_robot_cannot_do_is_not_sent(arena: Arena, wrong: tuple[float, float, float]) -> None:
    with connect(HOST, arena.port, "blue", 3) as robot:
        with pytest.raises(ValueError, match="too fast for this robot"):
            robot.drive(*wrong)
        with pytest.raises(ValueError, match="accepted: DriveLimits"):
            robot.drive(0.0, 0.0, 0.0, kick=6.0)
    assert arena.driven == []


def test_a_robot_that_is_not_simulated_is_refused_by_name(arena: Arena) -> None:
    with (
        connect(HOST, arena.port, "blue", 4) as robot,
        pytest.raises(ConnectionRefused, match="drive blue 4 at .*no_drive"),
    ):
        robot.drive(0.0, 0.0, 0.0)


def test_a_server_of_version_1_drives_no_robots() -> None:
    with (
        ScriptedServer(lambda _: [b"(init blue 3 play_on)", MIRROR]) as server,
        connect(HOST, server.port, "blue", 3) as robot,
        pytest.raises(ConnectionRefused, match="no_drive"),
    ):
        robot.drive(0.0, 0.0, 0.0)


def test_what_stands_still_is_seen_elsewhere_after_a_drive() -> None:
    assert Drive(1.0, 0.5).seen_after(2.0, 0.0, 2.0) == pytest.approx((0.0, -1.0))
    assert Drive(turn_rad_s=math.pi / 2.0).seen_after(1.0, 0.0, 1.0) == pytest.approx((0.0, -1.0))
    quarter = Drive(math.pi / 2.0, 0.0, math.pi / 2.0)  # a quarter of a circle of 1 m
    assert quarter.seen_after(0.0, 1.0, 1.0) == pytest.approx((0.0, 1.0))
    assert quarter.seen_after(1.0, 1.0, 1.0) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_a_robot_drives_to_a_point_and_turns_as_its_wheels_can() -> None:
    omni = Robot(Team.BLUE, 3, LIMITS, 0.09, (2.8, 2.3))
    drive = omni.towards(0.0, -0.2, 1.0)
    assert (drive.vx_m_s, drive.vy_m_s) == pytest.approx((0.0, -0.5), abs=1e-9)
    assert drive.turn_rad_s > 0.0
    assert omni.towards(9.0, 0.0, 0.0, most_m_s=0.7).vx_m_s == 0.7
    wheels = Robot(Team.BLUE, 3, DriveLimits(1.5, 0.0, 15.0, 0.0, dribbler=False), 0.0375, (1.5, 1.3))
    for x, y in ((0.5, 0.1), (-0.5, 0.1), (0.001, 0.0)):
        drive = wheels.towards(x, y, -1.0)
        assert wheels.limits.allow(wheels.limits.clipped(drive))
        assert drive.vy_m_s == 0.0
        assert drive.turn_rad_s * (y if x > 0.1 or x < 0.0 else -1.0) > 0.0
