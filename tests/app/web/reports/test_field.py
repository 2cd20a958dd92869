"""The field as the page draws it."""

import numpy as np
import pytest
from msgspec import structs

from app.web.reports.field import STEPS, Outlines, Points, RobotBody, field_from
from vision_core.clock import Instant
from vision_core.geometry import Floats, rotation
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.from_settings import mirror_of
from vision_core.rtdb.infos import ServiceInfo
from vision_core.settings.schema import MirrorConstants, Settings
from vision_core.types.objects import ObstacleSighting, RobotSighting, Team
from vision_core.venues.loader import load_settings

MIXED = load_settings(
    options={
        "robots.blue": {"pattern": "vsss-three-patch", "outline": "square", "radius_m": 0.04, "height_m": 0.06},
        "robots.yellow": {"pattern": "ssl-standard", "outline": "circle", "radius_m": 0.09, "height_m": 0.14},
    }
)


@pytest.fixture(scope="module")
def settings() -> Settings:
    return load_settings()


def test_mirror_table_inverts_the_mirror(settings: Settings) -> None:
    field = field_from(ServiceInfo("1", Instant(0), "", "", settings, ()))
    own = structs.replace(settings, mirror=structs.replace(settings.mirror, yellow=MirrorConstants(4.2, 0.0131, 91e3)))
    field = field_from(ServiceInfo("1", Instant(0), "", "", own, ()))
    assert field.mirror_m["blue"] != field.mirror_m["yellow"]
    for team in Team:
        mirror, table = mirror_of(own.mirror, team), field.mirror_m[team]
        known = [(px, metres) for px, metres in enumerate(table) if metres is not None]
        assert len(table) == 255
        assert len(known) == int(mirror.horizon_px) + 1
        for px, metres in known[:-3]:  # at the horizon a pixel spans more than the rounding
            assert mirror.px_from_mm(metres * 1000.0) == pytest.approx(px, abs=0.05)


def test_painted_lines_lie_where_the_camera_sees_them(settings: Settings) -> None:
    field = field_from(ServiceInfo("1", Instant(0), "", "", settings, ()))
    assert len(field.painted_px) == len(field.lines) + len(field.arcs)
    camera = CameraSetup.from_settings(settings).model
    for line, points in zip(field.lines, field.painted_px, strict=False):
        ends = camera.pixel_from_field(np.array([line[:2], line[2:]]))
        np.testing.assert_allclose([points[0], points[-1]], ends, atol=0.051)


def sighting(team: Team, x_m: float, y_m: float, heading_rad: float | None) -> RobotSighting:
    return RobotSighting(team, 3, 0.0, 0.0, x_m, y_m, heading_rad, 0.9, 0.001, 0.01)


def from_center(settings: Settings, points: Points, robot: RobotSighting, height_m: float) -> Floats:
    """Points of the picture in the robot's own axes [m]."""
    places = CameraSetup.from_settings(settings).model.field_from_pixel(np.array(points), height_m)
    return np.asarray((places - (robot.x_m, robot.y_m)) @ rotation(robot.heading_rad or 0.0))


def test_each_team_has_its_body() -> None:
    field = field_from(ServiceInfo("1", Instant(0), "", "", MIXED, ()))
    assert field.robots == {
        "blue": RobotBody(outline="square", radius_m=0.04),
        "yellow": RobotBody(outline="circle", radius_m=0.09),
    }


@pytest.mark.parametrize("heading", [0.7, -2.9, None])
def test_circles_begin_at_the_heading(heading: float | None) -> None:
    robot = sighting(Team.YELLOW, 0.4, -0.3, heading)
    (outline,) = Outlines(MIXED).of_robots([robot])
    points = from_center(MIXED, outline, robot, 0.14)
    assert len(points) == STEPS
    np.testing.assert_allclose(np.hypot(*points.T), 0.09, atol=1e-3)
    np.testing.assert_allclose(points[0], (0.09, 0.0), atol=1e-3)


def test_squares_are_turned_by_the_heading_and_begin_at_their_front() -> None:
    robots = [sighting(Team.BLUE, -0.5, 0.2, 0.7), sighting(Team.BLUE, 1.0, 0.8, -2.0)]
    for robot, outline in zip(robots, Outlines(MIXED).of_robots(robots), strict=True):
        points = from_center(MIXED, outline, robot, 0.06)
        np.testing.assert_allclose(np.abs(points).max(axis=1), 0.04, atol=1e-3)
        corners = np.abs(points).min(axis=1) > 0.039
        assert corners.sum() == 4
        np.testing.assert_allclose(points[0], (0.04, 0.0), atol=1e-3)


def test_a_square_of_unknown_heading_is_the_circle_in_it() -> None:
    robot = sighting(Team.BLUE, -0.5, 0.2, None)
    (outline,) = Outlines(MIXED).of_robots([robot])
    np.testing.assert_allclose(np.hypot(*from_center(MIXED, outline, robot, 0.06).T), 0.04, atol=1e-3)


def test_obstacles_are_circles_on_the_floor(settings: Settings) -> None:
    thing = ObstacleSighting(0.0, 0.0, 0.3, -0.6, 0.2, 0.7)
    (outline,) = Outlines(settings).of_obstacles([thing])
    places = CameraSetup.from_settings(settings).model.field_from_pixel(np.array(outline))
    np.testing.assert_allclose(np.hypot(*(places - (0.3, -0.6)).T), 0.2, atol=1e-3)


def test_nothing_has_no_outlines(settings: Settings) -> None:
    assert Outlines(settings).of_robots([]) == []
    assert Outlines(settings).of_obstacles([]) == []
