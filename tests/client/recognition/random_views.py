"""Views of a small field with random robots, as a ``see`` would tell them; and what a picture of 240 px can show."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.client.panorama import BODY_MM
from vision_core.client.recognition import paper_geometry
from vision_core.geometry import Floats, Mask
from vision_core.models.mirror import PAPER_MIRROR

HALF_X, HALF_Y, GOAL_HALF, GOAL_DEPTH = 1400.0, 1200.0, 350.0, 180.0
ROBOT_MM, BALL_MM = 90.0, 21.35
BORDER_PX = 1.5
"""So near to a border between two edges, along the circle, a pixel shows both."""
STEEP_PX, STEEP_SHARE = 3.0, 0.05
"""Neighbors whose radii differ by more are two edges."""


@dataclass(frozen=True)
class DrawnView:
    """What is drawn: arrays of shape (360,)."""

    letters: NDArray[np.str_]
    px: Floats
    """Whole pixels of equation 1."""
    ball: tuple[float, float, float] | None
    """Distance [px], direction and size [deg]."""


def random_view(rng: np.random.Generator) -> DrawnView:
    """A robot anywhere on the field, up to nine others, the ball somewhere."""
    me = rng.uniform([-HALF_X + 100.0, -HALF_Y + 100.0], [HALF_X - 100.0, HALF_Y - 100.0])
    heading = rng.uniform(0.0, 2.0 * math.pi)
    angles = heading + np.radians(np.arange(360.0))
    distances, letters = _walls(me, np.cos(angles), np.sin(angles))
    for number in range(rng.integers(0, 10)):
        away = rng.uniform([-HALF_X, -HALF_Y], [HALF_X, HALF_Y]) - me
        if math.hypot(*away) < 2.0 * ROBOT_MM:
            continue
        hit = _circle(away, ROBOT_MM, np.cos(angles), np.sin(angles))
        letters[hit < distances] = "x" if number % 2 else "y"
        distances = np.minimum(distances, hit)
    px = np.floor(PAPER_MIRROR.px_from_mm(np.maximum(distances, BODY_MM)))
    return DrawnView(letters, px, _ball(rng, me, heading, distances))


def _ball(rng: np.random.Generator, me: Floats, heading: float, edges_mm: Floats) -> tuple[float, float, float] | None:
    """A ball in front of the edges, farther away than the own body; None where it would not be."""
    away = rng.uniform([-HALF_X, -HALF_Y], [HALF_X, HALF_Y]) - me
    distance = math.hypot(*away)
    direction = round(math.degrees(math.atan2(away[1], away[0]) - heading)) % 360
    size = 2.0 * math.degrees(math.asin(min(BALL_MM / distance, 1.0)))
    beside = (direction + np.arange(-round(size), round(size) + 1)) % 360
    if distance < BODY_MM + 2.0 * BALL_MM or edges_mm[beside].min() < distance + BALL_MM:
        return None
    return math.floor(PAPER_MIRROR.px_from_mm(distance)), float(direction), float(max(round(size), 1))


def _walls(me: Floats, cosines: Floats, sines: Floats) -> tuple[Floats, NDArray[np.str_]]:
    """Distance and type of the field's limit; goals are openings of GOAL_DEPTH in the walls at both ends."""
    with np.errstate(divide="ignore"):
        to_end = (np.copysign(HALF_X, cosines) - me[0]) / cosines
        to_side = (np.copysign(HALF_Y, sines) - me[1]) / sines
        to_back = (np.copysign(HALF_X + GOAL_DEPTH, cosines) - me[0]) / cosines
        to_goal_side = (np.copysign(GOAL_HALF, sines) - me[1]) / sines
    is_end = to_end < to_side
    in_goal = is_end & (np.abs(me[1] + to_end * sines) < GOAL_HALF)
    inside = np.where(to_goal_side > to_end, to_goal_side, np.inf)
    distances = np.where(in_goal, np.minimum(to_back, inside), np.minimum(to_end, to_side))
    return distances, np.where(in_goal, np.where(cosines > 0.0, "u", "v"), "w")


def _circle(center: Floats, radius: float, cosines: Floats, sines: Floats) -> Floats:
    """Distance to a circle, inf where it is missed."""
    along = center[0] * cosines + center[1] * sines
    aside = center[0] * sines - center[1] * cosines
    hit = (along > 0.0) & (np.abs(aside) < radius)
    return np.where(hit, along - np.sqrt(np.maximum(radius**2 - aside**2, 0.0)), np.inf)


def clear_directions(view: DrawnView) -> Mask:
    """Directions that are more than BORDER_PX from another edge: nearer, no picture of this size shows them."""
    count = len(view.px)
    arc = view.px * (2.0 * math.pi / count) * paper_geometry(PAPER_MIRROR).scale
    reach = np.ceil(BORDER_PX / arc).astype(int)
    clear = np.ones(count, dtype=np.bool_)
    for aside in range(1, int(reach.max()) + 1):
        for shift in (aside, -aside):
            other = (np.roll(view.letters, shift) != view.letters) | (
                np.abs(np.roll(view.px, shift) - view.px) > np.maximum(STEEP_PX, STEEP_SHARE * view.px) * aside
            )
            clear &= ~(other & (aside <= reach))
    return clear
