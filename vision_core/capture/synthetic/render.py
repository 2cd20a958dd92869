"""Renders a snapshot of the world into an image."""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.background import make_background
from vision_core.capture.synthetic.bodies import FRONT_RADII, no_bodies
from vision_core.capture.synthetic.floor import FOOTPRINT_PX, GRID
from vision_core.capture.synthetic.noise import SensorNoise
from vision_core.capture.synthetic.sprites import LIGHT_X, LIGHT_Y, LIGHT_Z, Prism, draw_ball, draw_prism, draw_shadow
from vision_core.capture.synthetic.world import Snapshot
from vision_core.errors import SourceError
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.from_settings import robots_of
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.patterns.pattern import Patch, Pattern
from vision_core.patterns.worn import pattern_with_id, worn_patterns
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

PLATE_BGR, BODY_BGR = (52, 50, 50), (30, 29, 30)
TROUSERS_BGR, SHOE_BGR = (92, 66, 54), (44, 42, 46)

TIME_ORDER = np.array([[16, 3, 2, 13], [5, 10, 11, 8], [9, 6, 7, 12], [4, 15, 14, 1]])
"""Order in time of a pixel's 4x4 rays: a magic square. All rows and columns have the same mean time, so that offset
and time are not correlated: motion blur has the direction of the motion and shifts nothing."""

SHADOW_SOFTNESS_M = 0.03
SHADOW_PER_HEIGHT = (-LIGHT_X / LIGHT_Z, -LIGHT_Y / LIGHT_Z)
"""Offset of a point's shadow on the floor, per height of the point."""
LEG_M, SHOE_M = (0.055, 0.5), (0.045, 0.07)
"""Radius and height of a leg, and of one of the discs that make up a shoe."""
OCTAGON = np.column_stack([np.cos(np.arange(8) * math.pi / 4.0), np.sin(np.arange(8) * math.pi / 4.0)]) / math.cos(
    math.pi / 8.0
)
"""Corners of an octagon that contains the unit circle, shape (8, 2)."""


class Renderer:
    """Renders images of one camera and venue. The constructor renders the background, which takes a moment."""

    def __init__(self, settings: Settings, camera: CameraSetup, markers: tuple[tuple[Team, int], ...]) -> None:
        self._camera = camera.model
        self._eye = np.array(camera.model.position_m)
        self._background = make_background(settings, camera)
        self._noise = SensorNoise(settings.synthetic, self._background.pixels.size)
        exposure_s = settings.synthetic.exposure_ms * 1e-3
        self._half_exposure_s = 0.5 * exposure_s
        self._samples = exposure_samples(exposure_s)
        self._shadows = settings.synthetic.shadows
        self._ball_radius_m = settings.ball.radius_m
        self._ball_color = np.array(paint_bgr(settings.ball.color, "ball.color"), dtype=np.float64)
        patterns = {team: worn_patterns(settings.robots, team) for team in Team}
        self._robot_prisms = [robot_prism(settings, patterns[team], team, worn_id) for team, worn_id in markers]

    def draw(self, pixels: Bytes, scene: Snapshot) -> None:
        """Fill pixels, shape (height, width, 3), with the image of a scene."""
        background = self._background
        # all bodies: feet, robots, the ball last; their prisms and dimensions
        np.copyto(pixels, background.pixels)
        feet, foot_prisms = prisms_of_feet(scene.feet)
        bodies = np.concatenate([feet, scene.robots, scene.ball[None]])
        prisms = [*foot_prisms, *self._robot_prisms]
        ball = len(prisms)
        radii = np.array([*(outer_radius_m(prism) for prism in prisms), self._ball_radius_m])
        heights = np.array([*(prism.height for prism in prisms), 2.0 * self._ball_radius_m])
        reach = radii + self._half_exposure_s * np.hypot(bodies[:, 3], bodies[:, 4])
        # windows of bodies and shadows; a tip is where the shadow of the body's top falls
        bases = bodies[:, :2].copy()
        tips = bases + np.outer(np.minimum(heights, 1.5 * radii), SHADOW_PER_HEIGHT)
        windows, shadows = self._windows(pixels, bases, tips, reach, heights)
        # shadows of robots and ball; feet have none
        for i in range(len(feet) if self._shadows else ball + 1, ball + 1):
            softness = min(SHADOW_SOFTNESS_M, 0.5 * float(radii[i]))
            draw_shadow(pixels, background.floor, shadows[i], bases[i], tips[i], radii[i], softness, self._shadows)
        # bodies, the farthest from the camera first
        from_camera = bodies[:, :2] - self._eye[:2]
        order: list[int] = np.argsort(-np.hypot(from_camera[:, 0], from_camera[:, 1]), kind="stable").tolist()
        for i in order:
            if i == ball:
                draw_ball(
                    pixels, background.floor, background.light, windows[i], self._eye, self._samples,
                    bodies[i], self._ball_radius_m, self._ball_color,
                )  # fmt: skip
            else:
                draw_prism(
                    pixels,
                    background.floor,
                    background.light,
                    windows[i],
                    self._eye,
                    self._samples,
                    bodies[i],
                    prisms[i],
                )
        self._noise.add(pixels)

    def _windows(
        self, pixels: Bytes, bases: Floats, tips: Floats, reach: Floats, heights: Floats
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Bounding boxes of bodies and of their shadows, clipped to the image: u0, v0, u1, v1, shape (n, 4) [px]."""
        discs = reach[:, None, None] * OCTAGON
        soft_discs = (reach + SHADOW_SOFTNESS_M)[:, None, None] * OCTAGON
        base = bases[:, None]
        corners = np.stack([base + discs, base + discs, base + soft_discs, tips[:, None] + soft_discs])
        levels = np.zeros(corners.shape[:-1])
        levels[1] = heights[:, None]
        projected = self._camera.pixel_from_field(corners.reshape(-1, 2), levels.reshape(-1)).reshape(corners.shape)
        height, width, _ = pixels.shape
        limits = np.array([width, height])
        boxes = []
        for pair in (projected[:2], projected[2:]):
            first, last = np.floor(pair.min(axis=(0, 2))) - 1.0, np.ceil(pair.max(axis=(0, 2))) + 2.0
            box = np.concatenate([np.clip(first, 0.0, limits), np.clip(last, 0.0, limits)], axis=1)
            boxes.append(np.where(np.isfinite(box), box, 0.0).astype(np.int64))
        return boxes[0], boxes[1]


def exposure_samples(exposure_s: float) -> Floats:
    """Offsets of a pixel's 16 rays in the image and in time, shape (16, 3) [px, px, s]."""
    side = FOOTPRINT_PX * ((np.arange(GRID) + 0.5) / GRID - 0.5)
    v, u = np.meshgrid(side, side, indexing="ij")
    times = ((TIME_ORDER - 0.5) / 16.0 - 0.5) * exposure_s
    return np.column_stack([u.ravel(), v.ravel(), times.ravel()])


def robot_prism(settings: Settings, patterns: tuple[Pattern, ...], team: Team, worn_id: int) -> Prism:
    """The prism of a robot: its body with the patches of its marker."""
    if (pattern := pattern_with_id(patterns, worn_id)) is None:
        raise SourceError(
            f"synthetic: {team} robot with marker id {worn_id}",
            found=f"no such id in pattern {', '.join(pattern.name for pattern in patterns)}",
            accepted=", ".join(key for pattern in patterns for key in pattern.code.ids),
        )
    colors = pattern.colors_worn(team, worn_id)
    paints = [PLATE_BGR, BODY_BGR, *(paint_bgr(color, f"pattern {pattern.name}") for color in colors)]
    patches, corners = _patches(pattern.layout(worn_id))
    shape = robots_of(settings.robots, team)
    square = shape.outline == "square"
    front = math.inf if square else FRONT_RADII * shape.radius_m
    return Prism(shape.radius_m, front, square, shape.height_m, np.array(paints, dtype=np.float64), patches, corners)


def _patches(worn: Iterable[Patch]) -> tuple[Floats, Floats]:
    """Patches and corners of a ``Prism``."""
    rows: list[tuple[float, ...]] = []
    corners: list[tuple[float, float]] = []
    for patch in worn:
        if patch.circle_mm is not None:
            x, y, diameter = patch.circle_mm
            rows.append((x / 1e3, y / 1e3, diameter / 2.0 / 1e3, 0, 0))
        else:
            assert patch.polygon_mm is not None
            polygon = np.array(patch.polygon_mm[:-1]) / 1e3
            middle = polygon.mean(axis=0)
            radius = float(np.hypot(*(polygon - middle).T).max())
            rows.append((*middle.tolist(), radius, len(corners), len(corners) + len(polygon)))
            corners += [(x, y) for x, y in polygon.tolist()]
    return np.array(rows, dtype=np.float64), np.array(corners, dtype=np.float64).reshape(-1, 2)


def outer_radius_m(prism: Prism) -> float:
    """Radius of the circle round a body."""
    return prism.radius * (math.sqrt(2.0) if prism.square else 1.0)


def paint_bgr(name: str, asked: str) -> tuple[int, int, int]:
    """The color of a paint; asked: what it is for. Raises SourceError when there is no such paint."""
    if name not in PAINTS_BGR:
        raise SourceError(f"synthetic: paint for {asked}", found=name, accepted=", ".join(PAINTS_BGR))
    return PAINTS_BGR[name]


def _cylinder(size_m: tuple[float, float], bgr: tuple[int, int, int]) -> Prism:
    """A cylinder of one color."""
    radius, height = size_m
    colors = np.array([bgr, bgr], dtype=np.float64)
    return Prism(radius, math.inf, False, height, colors, np.empty((0, 5)), np.empty((0, 2)))


FOOT_PARTS = (
    *((along_m, _cylinder(SHOE_M, SHOE_BGR)) for along_m in (0.0, 0.05, 0.10, 0.15)),
    (0.0, _cylinder(LEG_M, TROUSERS_BGR)),
)
"""A foot is a shoe, made of four discs, and the leg above: how far forward each part lies [m], and its prism."""


def prisms_of_feet(feet: Floats) -> tuple[Floats, list[Prism]]:
    """Bodies of all parts of m feet, shape (5 m, 6), and their prisms."""
    parts = no_bodies(len(feet) * len(FOOT_PARTS))
    prisms = []
    for i, foot in enumerate(feet):
        for j, (along_m, prism) in enumerate(FOOT_PARTS):
            part = parts[i * len(FOOT_PARTS) + j]
            part[:] = foot
            part[:2] += along_m * np.array([math.cos(foot[2]), math.sin(foot[2])])
            prisms.append(prism)
    return parts, prisms
