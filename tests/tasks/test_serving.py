"""Sightings in, datagrams out: the stages joined as the service joins them."""

import math

import pytest

from vision_core.clock import NS_PER_S, Instant
from vision_core.protocol.codec import decode_message
from vision_core.protocol.messages import See
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.settings_files import load_settings
from vision_core.tasks.serving import Scene, SceneMaker
from vision_core.types.field import EdgeKind
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team

SETTINGS = load_settings()
BOOT = Instant(NS_PER_S)


def robot(team: Team, number: int, x_m: float, y_m: float, heading_rad: float = 0.0) -> RobotSighting:
    ids = SETTINGS.match.blue_ids if team is Team.BLUE else SETTINGS.match.yellow_ids
    return RobotSighting(team, ids[number - 1], 0.0, 0.0, x_m, y_m, heading_rad, 1.0, 0.001, 0.01)


@pytest.fixture
def maker() -> SceneMaker:
    return SceneMaker(SETTINGS, BOOT)


@pytest.fixture
def scene(maker: SceneMaker) -> Scene:
    """Blue 1 in the middle looks at yellow 2, a meter ahead; the ball lies half a meter to its left."""
    robots = (robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.YELLOW, 2, 1.0, 0.0))
    ball = BallSighting(0.0, 0.0, 0.0, 0.5, 1.0, 0.001)
    at = Instant(BOOT + 20_306_148_000_000)
    return maker.scene(Sightings("main", 7, at, at, robots, (ball,), ()))


def see(maker: SceneMaker, scene: Scene, options: Options = PAPER_OPTIONS) -> See:
    datagram = maker.datagram(scene, Team.BLUE, 1, options, nul=False)
    assert datagram is not None
    message = decode_message(datagram)
    assert isinstance(message, See)
    return message


def test_what_blue_1_sees(maker: SceneMaker, scene: Scene) -> None:
    message = see(maker, scene)
    assert message.time_us == 20_306_148_000
    assert len(message.edges) == 1080
    ahead_px = int(maker._mirror.px_from_mm(1000.0 - 90.0))
    assert message.edges[:3] == f"r{ahead_px:02x}".encode()
    to_the_left_px = int(maker._mirror.px_from_mm(1000.0 * SETTINGS.field.width_m / 2.0))
    assert message.edges[270:273] == f"w{to_the_left_px:02x}".encode()
    ball_px = int(maker._mirror.px_from_mm(500.0))
    size_deg = round(math.degrees(2.0 * math.asin(SETTINGS.ball.radius_m / 0.5)))
    assert (message.ball.px, message.ball.direction_deg, message.ball.size_deg) == (ball_px, 90, size_deg)


def test_everybody_with_a_number_is_in_the_scene(scene: Scene) -> None:
    assert set(scene.views) == {(Team.BLUE, 1), (Team.YELLOW, 2)}


def test_a_robot_that_is_not_in_the_world_gets_nothing(maker: SceneMaker, scene: Scene) -> None:
    assert maker.datagram(scene, Team.BLUE, 2, PAPER_OPTIONS, nul=False) is None


def test_finer_directions_are_computed_not_interpolated(maker: SceneMaker, scene: Scene) -> None:
    fine = Options(fov_deg=90.0, center_deg=0.0, resolution_deg=0.25)
    message = see(maker, scene, fine)
    assert len(message.edges) == 3 * 360
    whole = see(maker, scene).edges
    for index in range(0, 360, 4):
        direction = (index // 4 - 45) % 360
        assert message.edges[3 * index : 3 * index + 3] == whole[3 * direction : 3 * direction + 3]


def test_the_page_gets_the_pixels_of_the_wire(maker: SceneMaker, scene: Scene) -> None:
    snapshot = next(view for view in maker.snapshot(scene).views if view.team is Team.BLUE)
    message = see(maker, scene)
    assert snapshot.px.hex() == "".join(message.edges[i + 1 : i + 3].decode() for i in range(0, 1080, 3))
    assert snapshot.kinds[0] == EdgeKind.ROBOT_YELLOW + 2
    assert (snapshot.ball_px, snapshot.ball_direction_deg) == (message.ball.px, message.ball.direction_deg)
