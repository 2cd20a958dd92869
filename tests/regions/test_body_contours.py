"""What a robot covers, against rays that are traced to its cylinder."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.geometry import Floats
from vision_core.regions.body_contours import OUTLINE_POINTS, BodySilhouettes

EYE = np.array([0.2, -0.1, 3.0])
RADIUS, HEIGHT, BALL = 0.09, 0.15, 0.0215
coordinate = st.floats(-2.0, 2.0)


def hits_cylinder(eye: Floats, floor: Floats, robot: Floats, radius: float, height: float) -> bool:
    """Does a ray from the floor to the eye go through a cylinder? Tried at many heights."""
    shares = np.linspace(0.0, height / eye[2], 4001)[:, None]
    points = floor + (eye[:2] - floor) * shares
    return bool((np.hypot(*(points - robot).T) <= radius).any())


def off_hull(eye: Floats, floor: Floats, robot: Floats) -> float:
    """Distance from the silhouette of the robots of these tests, by its many circles."""
    shares = np.linspace(0.0, HEIGHT, 4001)[:, None]
    growth = shares / (eye[2] - shares)
    centers, radii = robot + (robot - eye[:2]) * growth, RADIUS * (1.0 + growth[:, 0])
    return float((np.hypot(*(floor - centers).T) - radii).min())


@given(coordinate, coordinate, st.floats(-0.4, 0.4), st.floats(-0.4, 0.4))
def test_a_point_is_covered_where_its_ray_meets_the_body(x: float, y: float, dx: float, dy: float) -> None:
    robot, point = np.array([x, y]), np.array([x + dx, y + dy])
    if abs(off_hull(EYE, point, robot)) < 1e-4:
        return
    (covered,) = BodySilhouettes(EYE, RADIUS, HEIGHT).covered(point[None], robot[None])
    assert covered == hits_cylinder(EYE, point, robot, RADIUS, HEIGHT)


@given(coordinate, coordinate)
def test_the_outline_is_the_border_of_what_is_covered(x: float, y: float) -> None:
    robot = np.array([[x, y]])
    silhouettes = BodySilhouettes(EYE, RADIUS, HEIGHT)
    (outline,) = silhouettes.outlines(robot)
    assert outline.shape == (OUTLINE_POINTS, 2)
    middle = outline.mean(axis=0)
    assert silhouettes.covered(middle + (outline - middle) * 0.98, robot).all()
    assert not silhouettes.covered(middle + (outline - middle) * 1.02, robot).any()
    before, after = outline - np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0) - outline
    assert (before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > -1e-9).all()


def test_a_ball_behind_a_robot_may_be_hidden_far_from_the_camera_only() -> None:
    """The hidden strip is r h / (H - h) long: as long as a ball is wide where r is 1.1 m."""
    silhouettes = BodySilhouettes(np.array([0.0, 0.0, 4.0]), RADIUS, HEIGHT)
    places = np.array([(0.0, 0.0), (0.5, 0.0), (1.6, 0.0), (0.0, -3.0)])
    assert silhouettes.can_hide(BALL, places).tolist() == [False, False, True, True]
    shares = [
        silhouettes.hidden_share(np.array([x + RADIUS + BALL, 0.0]), BALL, np.array([[x, 0.0]])) for x in (0.8, 1.3)
    ]
    assert shares[0] < 1.0 == shares[1]


def test_how_much_of_a_ball_is_hidden_and_by_whom() -> None:
    silhouettes = BodySilhouettes(np.array([0.0, 0.0, 4.0]), RADIUS, HEIGHT)
    robots = np.array([(2.0, 0.0), (2.0, 0.5)])
    behind, beside = np.array([2.0 + RADIUS + BALL, 0.0]), np.array([2.0, 0.25])
    assert silhouettes.hidden_share(behind, BALL, robots) == 1.0
    assert silhouettes.hiding(behind, BALL, robots).tolist() == [True, False]
    assert silhouettes.hidden_share(beside, BALL, robots) == 0.0
    assert not silhouettes.hiding(beside, BALL, robots).any()


def test_without_robots_nothing_is_covered() -> None:
    silhouettes, none = BodySilhouettes(EYE, RADIUS, HEIGHT), np.zeros((0, 2))
    assert silhouettes.covered(np.zeros((3, 2)), none).tolist() == [False] * 3
    assert silhouettes.outlines(none).shape == (0, OUTLINE_POINTS, 2)
    assert silhouettes.can_hide(BALL, none).shape == (0,)
    assert silhouettes.hidden_share(np.zeros(2), BALL, none) == 0.0


def test_a_camera_below_the_robots_is_refused() -> None:
    with pytest.raises(ValueError, match="does not look down on"):
        BodySilhouettes(np.array([0.0, 0.0, 0.1]), RADIUS, HEIGHT)


def test_a_margin_widens_the_body() -> None:
    silhouettes, robot = BodySilhouettes(EYE, RADIUS, HEIGHT), np.array([[0.2, -0.1]])
    edge = RADIUS * EYE[2] / (EYE[2] - HEIGHT)
    points = robot + edge * np.column_stack([np.cos([0.0, 2.0]), np.sin([0.0, 2.0])]) * 1.01
    assert not silhouettes.covered(points, robot).any()
    assert silhouettes.covered(points, robot, margin_m=0.02).all()
    assert math.isclose(edge, np.hypot(*(silhouettes.outlines(robot)[0, 0] - robot[0])))
