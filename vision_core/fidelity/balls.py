"""How far the two sides agree about the ball, and why they do not."""

import math
from dataclasses import dataclass
from enum import StrEnum

from vision_core.fidelity.ceiling import Detection
from vision_core.geometry import wrap_angle
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import Mirror
from vision_core.onboard.truth import SeenBall
from vision_core.protocol.messages import Ball

HALF = 0.5
"""A smaller share of the ball is a part of it."""
LEAST_PX = 1.0
"""An ideal camera of the on-board picture's resolution sees a ball of which at least so much shows [px of it]."""


class BallCause(StrEnum):
    """Why the two sides disagree whether the ball is hidden; in the order of the table."""

    CEILING = "hidden from the ceiling camera"
    DETECTION = "missed by the ceiling camera"
    MODEL = "seen over a low robot or past a flat front"
    SMALL = "less than a pixel of it shows on board"
    PARTLY = "less than half of it shows on board"
    MODULE = "error of the on-board module"


@dataclass(frozen=True, slots=True)
class BallComparison:
    """The ball of one world."""

    same_hidden: bool
    cause: BallCause | None
    """Of a disagreement whether it is hidden."""
    shown_px: float
    """The area that shows of it in the on-board picture [px of the picture]."""
    distance_mm: float
    """Where it truly is, from the robot's center."""
    told: bool
    """The ceiling's side tells where it is."""
    seen: bool
    """The on-board side sees it."""
    onboard_share: float
    """The share of it that the on-board picture shows, exactly."""
    ceiling_share: float
    """The share of it that the ceiling camera's picture shows."""
    error_px: int | None
    """Told minus seen, if both see it: distance, direction and size."""
    direction_deg: float | None
    size_deg: int | None

    @property
    def is_clear(self) -> bool:
        """It is hidden, or as much of it shows as the on-board picture can resolve."""
        return self.shown_px == 0.0 or self.shown_px >= LEAST_PX

    @property
    def same_as_ideal(self) -> bool:
        """The ceiling's side tells it exactly when an ideal camera of the on-board picture's resolution sees it."""
        return self.told == (self.shown_px >= LEAST_PX)


def compare_balls(
    told: Ball, seen: Ball, exact_view: Ball, truth: SeenBall, detection: Detection, mirror: Mirror, scale: float
) -> BallComparison:  # fmt: skip
    """Compare what the ceiling's side told with what the on-board side saw.

    exact_view: what would be told if poses were known exactly; scale: pixels of the picture per pixel of equation 1.
    """
    both = not told.hidden and not seen.hidden
    shown_px = truth.share * ball_area_px(truth, mirror, scale)
    return BallComparison(
        same_hidden=told.hidden == seen.hidden,
        cause=None if told.hidden == seen.hidden else _cause(told, exact_view, truth, detection, shown_px),
        shown_px=shown_px,
        distance_mm=truth.distance_mm,
        told=not told.hidden,
        seen=not seen.hidden,
        onboard_share=truth.share,
        ceiling_share=detection.ball_share,
        error_px=told.px - seen.px if both else None,
        direction_deg=_turn_deg(told.direction_deg - seen.direction_deg) if both else None,
        size_deg=told.size_deg - seen.size_deg if both else None,
    )


def _cause(told: Ball, exact_view: Ball, truth: SeenBall, detection: Detection, shown_px: float) -> BallCause:
    if told.hidden and not exact_view.hidden:
        return BallCause.CEILING if detection.ball_share < HALF else BallCause.DETECTION
    if told.hidden:
        return BallCause.MODEL if truth.share > 0.0 else BallCause.MODULE
    if shown_px < LEAST_PX:
        return BallCause.SMALL
    return BallCause.PARTLY if truth.share < HALF else BallCause.MODULE


def ball_area_px(ball: SeenBall, mirror: Mirror, scale: float) -> float:
    """Area of the whole ball in the on-board picture [px of the picture]: an ellipse."""
    radius = ball.distance_mm * math.sin(math.radians(min(ball.size_deg, 180.0) / 2.0))
    height = Hyperboloid.of(mirror).height_mm
    slant = math.hypot(ball.distance_mm, height - radius)
    half, middle = math.asin(min(radius / slant, 1.0)), math.atan2(ball.distance_mm, height - radius)
    near, far = (
        mirror.px_from_mm(height * math.tan(min(max(angle, 0.0), math.radians(89.9))))
        for angle in (middle - half, middle + half)
    )
    across = 0.5 * (near + far) * math.radians(ball.size_deg)
    return math.pi / 4.0 * across * (far - near) * scale * scale


def _turn_deg(angle_deg: float) -> float:
    return math.degrees(wrap_angle(math.radians(angle_deg)))
