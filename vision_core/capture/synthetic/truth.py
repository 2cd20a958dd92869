"""Ground truth of a simulated image, for scoring only: perception must not use it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.bodies import FRONT_RADII
from vision_core.capture.synthetic.sprites import meets_body
from vision_core.capture.synthetic.world import Snapshot
from vision_core.clock import Instant
from vision_core.geometry import Floats, wrap_angle
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.from_settings import robots_of
from vision_core.native.kernels import kernel
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

Mask = NDArray[np.bool_]

RINGS, SPOKES = 5, 16
"""The ball's visible share is measured at 5 x 16 points of its disc."""
RIM_POINTS = 8
"""Points on the rim of a robot's top that must be inside the image."""


@dataclass(frozen=True, slots=True)
class RobotTruth:
    """Pose of a robot at mid-exposure."""

    team: Team
    id: int
    x_m: float
    y_m: float
    heading_rad: float
    in_picture: bool
    """Whether its whole top is inside the image."""


@dataclass(frozen=True, slots=True)
class BallTruth:
    """The ball at mid-exposure; x_m, y_m: where it touches the floor."""

    x_m: float
    y_m: float
    visible_share: float
    """Share of its disc, as the camera sees it, that is inside the image and not hidden by robots, 0..1."""


@dataclass(frozen=True, slots=True)
class Truth:
    """Ground truth of one image."""

    instant: Instant
    robots: tuple[RobotTruth, ...]
    ball: BallTruth


def truth_of(
    instant: Instant, scene: Snapshot, worn: tuple[tuple[Team, int], ...], camera: CameraSetup, settings: Settings
) -> Truth:
    """The truth of a scene; worn: team and marker id of each robot."""
    shapes = _shapes(worn, settings)
    inside = _tops_inside(scene.robots, shapes, camera)
    robots = tuple(
        RobotTruth(team, worn_id, float(body[0]), float(body[1]), wrap_angle(float(body[2])), bool(seen))
        for (team, worn_id), body, seen in zip(worn, scene.robots, inside, strict=True)
    )
    x, y = scene.ball[:2].tolist()
    return Truth(instant, robots, BallTruth(x, y, visible_share(scene, camera, settings, shapes)))


def visible_share(scene: Snapshot, camera: CameraSetup, settings: Settings, shapes: Floats | None = None) -> float:
    """The share of the ball's disc, as the camera sees it, that is inside the image and not hidden by a robot.

    shapes: of the robots, as ``_shapes`` returns them; None: all have the shape of blue robots.
    """
    if shapes is None:
        shapes = _shapes([(Team.BLUE, 0)] * len(scene.robots), settings)
    points = disc_points(scene.ball, settings.ball.radius_m, camera.model.position_m)
    inside = _in_image(camera.model.pixel_from_field(points[:, :2], points[:, 2]), camera)
    clear = clear_points(points, np.array(camera.model.position_m), scene.robots, shapes)
    return float((inside & clear).mean())


@kernel
def clear_points(points: Floats, eye: Floats, robots: Floats, shapes: Floats) -> Mask:
    """Which points, shape (n, 3), no robot hides from the eye (the optical center); shape (n,).

    shapes: radius, front, height [m] and whether it is a square, of every robot, shape (m, 4).
    """
    clear = np.ones(len(points), dtype=np.bool_)
    for i in range(len(points)):
        x, y, z = points[i]
        for j in range(len(robots)):
            # the line of sight from the point to the height of the robot's top, in the robot's space
            height_ratio = (shapes[j, 2] - z) / (eye[2] - z)
            c, s = math.cos(robots[j, 2]), math.sin(robots[j, 2])
            dx, dy = x - robots[j, 0], y - robots[j, 1]
            ex, ey = dx + (eye[0] - x) * height_ratio, dy + (eye[1] - y) * height_ratio
            near, aside = c * dx + s * dy, c * dy - s * dx
            tx, ty = c * ex + s * ey, c * ey - s * ex
            if meets_body(near, aside, tx, ty, shapes[j, 0], shapes[j, 1], shapes[j, 3] > 0.0):
                clear[i] = False
                break
    return clear


def disc_points(ball: Floats, radius_m: float, eye: Floats) -> Floats:
    """Points of equal area on the ball's disc perpendicular to the line of sight, shape (n, 3)."""
    center = np.array([ball[0], ball[1], radius_m])
    sight = eye - center
    sight /= math.hypot(*sight)
    across = np.cross(sight, [1.0, 0.0, 0.0])
    across /= math.hypot(*across)
    up = np.cross(sight, across)
    rings = radius_m * np.sqrt((np.arange(RINGS) + 0.5) / RINGS)
    turns = np.arange(SPOKES) * (math.tau / SPOKES)
    spokes = np.cos(turns)[:, None] * across + np.sin(turns)[:, None] * up
    points: Floats = center + (rings[:, None, None] * spokes).reshape(-1, 3)
    return points


def _shapes(worn: Sequence[tuple[Team, int]], settings: Settings) -> Floats:
    """Radius, front, height [m] and whether it is a square, of every robot, shape (n, 4)."""
    rows = []
    for team, _ in worn:
        shape = robots_of(settings.robots, team)
        square = shape.outline == "square"
        front = math.inf if square else FRONT_RADII * shape.radius_m
        rows.append((shape.radius_m, front, shape.height_m, float(square)))
    return np.array(rows, dtype=np.float64).reshape(-1, 4)


def _tops_inside(robots: Floats, shapes: Floats, camera: CameraSetup) -> Mask:
    """Whether each robot's whole top is inside the image, shape (n,)."""
    turns = np.arange(RIM_POINTS) * (math.tau / RIM_POINTS)
    reach = shapes[:, 0] * np.where(shapes[:, 3] > 0.0, math.sqrt(2.0), 1.0)
    rim = reach[:, None, None] * np.column_stack([np.cos(turns), np.sin(turns)])
    points = (robots[:, None, :2] + rim).reshape(-1, 2)
    pixels = camera.model.pixel_from_field(points, np.repeat(shapes[:, 2], RIM_POINTS))
    return np.asarray(_in_image(pixels, camera).reshape(-1, RIM_POINTS).all(axis=1))


def _in_image(pixels: Floats, camera: CameraSetup) -> Mask:
    size = np.array(camera.size_px)
    return np.asarray(((pixels >= -0.5) & (pixels <= size - 0.5)).all(axis=1))
