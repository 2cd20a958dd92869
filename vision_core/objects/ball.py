"""The ball, by a table of gates."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.camera_model import CameraModel
from vision_core.field_model import is_accepted, is_between_lines
from vision_core.geometry import Bytes, Floats
from vision_core.objects.likeness import likeness
from vision_core.settings import BallSettings, FieldSettings
from vision_core.types.blobs import Blobs
from vision_core.types.colors import ColorTable
from vision_core.types.objects import BallSighting, RobotSighting

Mask = NDArray[np.bool_]

RING_POINTS = 24
RING_RADII = 1.8
"""Where the surroundings are looked at, in radii of the ball: outside its blurred rim, inside its shadow."""

MOST_BALLS = 32
"""There is one; what a cloth of dots shows beyond these must not fill the database."""

ROUND_FILL = math.pi / 4.0
"""Share of its box that a disc fills."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """Blobs of the ball's color and what the gates ask of them, as arrays of equal length."""

    pixel: Floats
    place_m: Floats
    """Point of the floor under each, shape (n, 2)."""
    share: Floats
    """Area over the predicted one."""
    elongation: Floats
    fill: Floats
    surrounding: Floats
    """Share of the ring round each that has one of the surrounding classes."""
    robot_m: Floats
    """Distance to the nearest robot's center, inf without robots."""
    accepted: Mask
    """On the field, its margin or in a goal."""

    def __len__(self) -> int:
        return len(self.share)


Gate = Callable[[Candidates, BallSettings], Mask]

GATES: tuple[tuple[str, Gate], ...] = (
    ("off the field", lambda blob, _: blob.accepted),
    ("too small (ball.min_area)", lambda blob, ball: blob.share >= ball.min_area),
    ("too large (ball.max_area)", lambda blob, ball: blob.share <= ball.max_area),
    ("too long (ball.max_elongation)", lambda blob, ball: blob.elongation <= ball.max_elongation),
    ("too ragged (ball.min_fill)", lambda blob, ball: blob.fill >= ball.min_fill),
    ("on a robot (ball.inside_robot_m)", lambda blob, ball: blob.robot_m >= ball.inside_robot_m),
    ("in the wrong surroundings (ball.surrounding)", lambda blob, ball: blob.surrounding >= ball.min_surrounding),
    ("below ball.min_confidence", lambda blob, ball: confidence(blob) >= ball.min_confidence),
)
"""What a blob must pass to be a ball, and what it is otherwise."""


def find_balls(
    blobs: Blobs,
    table: ColorTable,
    pixels: Bytes,
    camera: CameraModel,
    robots: Sequence[RobotSighting],
    ball: BallSettings,
    field: FieldSettings,
) -> tuple[tuple[BallSighting, ...], tuple[str, ...]]:
    """The balls that blobs show, those between the lines first, then by confidence, and why there is none.

    At most MOST_BALLS, the first ones.
    pixels: the picture itself, shape (height, width, 3), for the surroundings; table: of all classes.
    """
    found = _candidates(blobs, table, pixels, camera, robots, ball, field)
    passed = np.column_stack([gate(found, ball) for _, gate in GATES])
    if not passed.all(axis=1).any():
        return (), (_why_none(passed, ball),)
    confidences = confidence(found)
    balls = [
        BallSighting(
            x_px=float(found.pixel[blob, 0]),
            y_px=float(found.pixel[blob, 1]),
            x_m=float(found.place_m[blob, 0]),
            y_m=float(found.place_m[blob, 1]),
            confidence=float(confidences[blob]),
            position_sd_m=0.001,
        )
        for blob in np.flatnonzero(passed.all(axis=1))
    ]
    balls.sort(key=lambda one: (not is_between_lines(field, one.x_m, one.y_m), -one.confidence))
    return tuple(balls[:MOST_BALLS]), ()


def confidence(found: Candidates) -> Floats:
    """How like a ball each candidate is, 0..1: its size, its roundness, its fill."""
    roundness = np.sqrt(1.0 / found.elongation) * np.minimum(found.fill / ROUND_FILL, 1.0)
    alike: Floats = likeness(found.share) * roundness
    return alike


def _candidates(
    blobs: Blobs,
    table: ColorTable,
    pixels: Bytes,
    camera: CameraModel,
    robots: Sequence[RobotSighting],
    ball: BallSettings,
    field: FieldSettings,
) -> Candidates:
    chosen = np.flatnonzero(blobs.color == table.index(ball.color))
    pixel, area, box = blobs.center_px[chosen], blobs.area_px[chosen], blobs.box_px[chosen]
    place = camera.field_from_pixel(pixel, ball.radius_m)
    scale = camera.pixels_per_square_metre(place, ball.radius_m)
    sides = box[:, 2:] - box[:, :2] + 1
    return Candidates(
        pixel=pixel,
        place_m=place,
        share=area / (math.pi * ball.radius_m**2 * scale),
        elongation=sides.max(axis=1) / sides.min(axis=1),
        fill=area / sides.prod(axis=1),
        surrounding=_surrounding(pixels, table, pixel, ball.radius_m * np.sqrt(scale), ball),
        robot_m=_nearest_robot_m(place, robots),
        accepted=_accepted(place, ball.radius_m, field),
    )


def _surrounding(pixels: Bytes, table: ColorTable, centers: Floats, radii_px: Floats, ball: BallSettings) -> Floats:
    """Share of a ring round each center that has one of the wanted classes; the picture's outside has not."""
    if not ball.surrounding:
        return np.ones(len(centers))
    turn = np.arange(RING_POINTS) * (math.tau / RING_POINTS)
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    points = np.rint(centers[:, None] + RING_RADII * radii_px[:, None, None] * ring).astype(np.intp)
    height, width, _ = pixels.shape
    inside = ((points >= 0) & (points < (width, height))).all(axis=2)
    x, y = np.clip(points[..., 0], 0, width - 1), np.clip(points[..., 1], 0, height - 1)
    wanted = np.array([name in ball.surrounding for name in table.names])
    share: Floats = (wanted[table.classes_of(pixels[y, x])] & inside).mean(axis=1)
    return share


def _nearest_robot_m(places: Floats, robots: Sequence[RobotSighting]) -> Floats:
    centers = np.array([(robot.x_m, robot.y_m) for robot in robots]).reshape(-1, 2)
    arms = places[:, None] - centers
    nearest: Floats = np.hypot(arms[..., 0], arms[..., 1]).min(axis=1, initial=math.inf)
    return nearest


def _accepted(places: Floats, tolerance_m: float, field: FieldSettings) -> Mask:
    """Which places are accepted, or would be one tolerance nearer to the field's center along each axis."""
    inwards = np.sign(places) * np.maximum(np.abs(places) - tolerance_m, 0.0)
    return np.array([is_accepted(field, x, y) for x, y in inwards.tolist()], dtype=np.bool_)


def _why_none(passed: Mask, ball: BallSettings) -> str:
    """How many blobs each gate stopped, where the first gate that stops one counts."""
    if not len(passed):
        return f"no ball: no {ball.color} blob"
    stopped = np.bincount(passed.argmin(axis=1), minlength=len(GATES))
    parts = [f"{count} {name}" for (name, _), count in zip(GATES, stopped.tolist(), strict=True) if count]
    return f"no ball: {len(passed)} {ball.color} blobs: {', '.join(parts)}"
