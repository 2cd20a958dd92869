"""Why the two sides disagree in a direction: each disagreement gets one cause, with its evidence from the truth.

The truth stands between both sides. What both have right, each within a direction and a half and a pixel of the exact
picture, is a disagreement of rounding: at an object's edge or along a smooth one. What the on-board side has wrong is
explained by what the picture shows there: the own body, a line on the floor before a wall, the ball before a foot,
something seen over a low object or beyond a limit that is only paint, or an error of the on-board module that is small
in place or in type only. What the ceiling's side has wrong is the model's (robots are circles without a flat front) if
the exact poses give the same, otherwise a detection error. Anything else is unexplained.
"""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from vision_core.fidelity.agreement import compare
from vision_core.fidelity.reports import Report
from vision_core.geometry import Floats, Mask
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import MM_PER_M, Mirror
from vision_core.onboard.scene import Scene
from vision_core.onboard.truth import FirstSolids, SeenBall

FINER = 4
"""Directions of the exact picture per direction of the reports."""
WINDOW_DEG = 1.5
"""A report is right about an edge so far aside."""
EDGE_PX = 2.0
"""A larger step of the exact radius within the window is an object's edge."""
MAX_PLACE_PX = 3.0
"""The module's error of place is smaller than this; anything else is not its resolution."""
NEAR_PX = 1.5
"""Slack of the borders of causes [px]: blur of the picture and rounding."""
WALL = "w"


class Cause(StrEnum):
    """Why two reports disagree in a direction; in the order of the table."""

    EDGE = "edge or sub-degree sliver of an object"
    QUANTIZATION = "quantization at both ends"
    OUTLINE = "a robot's flat front, which is a circle in a view"
    DETECTION = "detection error of the ceiling camera"
    OWN_BODY = "nearer than the own body lets see"
    WALL_LINE = "white line painted at a white wall's foot"
    BALL = "the ball stands before the foot"
    SEEN_OVER = "seen over a low robot or wall"
    BEYOND = "beyond the nearest edge, which is only a limit"
    MODULE_PLACE = "on-board module: up to 3 px beside"
    MODULE_SIDE = "on-board module: a part of the object's side"
    UNEXPLAINED = "unexplained"


@dataclass(frozen=True, slots=True)
class Evidence:
    """The truth of one world, for explaining only."""

    exact_view: Report
    """What PSLV would tell if it knew the poses exactly."""
    exact: Report
    """What the on-board picture shows, exactly, FINER directions for one."""
    solids: FirstSolids
    """The same as solids."""
    ball: SeenBall
    scene: Scene
    mirror: Mirror
    scale: float
    """Pixels of the on-board picture per pixel of equation 1."""
    nearest_px: float
    """The own body hides the floor nearer than this."""
    line_mm: float
    """Width of a line painted at the walls' feet; 0: there is none."""


def explain(told: Report, seen: Report, truth: Evidence) -> list[Cause | None]:
    """The cause of each direction's disagreement of what the ceiling's side told and the on-board side saw.

    None where they agree.
    """
    disagree = ~compare(told, seen).agrees
    reach = round(WINDOW_DEG * FINER)
    told_right = compare(told, truth.exact, reach).agrees
    seen_right = compare(seen, truth.exact, reach).agrees
    model_right = compare(truth.exact_view, truth.exact, reach).agrees
    at_edge = _at_edge(truth.exact, len(told.letters), reach)
    causes: list[Cause | None] = [None] * len(told.letters)
    for i in np.flatnonzero(disagree).tolist():
        if told_right[i] and seen_right[i]:
            causes[i] = Cause.EDGE if at_edge[i] else Cause.QUANTIZATION
        elif seen_right[i]:
            causes[i] = Cause.DETECTION if model_right[i] else Cause.OUTLINE
        else:
            causes[i] = _onboard_cause(i, seen, truth, at_edge=bool(at_edge[i]))
    return causes


def _at_edge(exact: Report, n: int, reach: int) -> Mask:
    """Whether an edge of an object lies within the window of each of n directions."""
    finer = len(exact.letters) // n
    window = (np.arange(n)[:, None] * finer + np.arange(-reach, reach + 1)) % len(exact.letters)
    radii, letters = np.minimum(exact.radii_px[window], 1e3), exact.letters[window]
    steps = np.abs(np.diff(radii, axis=1)).max(axis=1)
    return np.asarray((letters != letters[:, :1]).any(axis=1) | (steps > EDGE_PX))


def _onboard_cause(i: int, seen: Report, truth: Evidence, *, at_edge: bool) -> Cause:
    """Why the on-board side is wrong in a direction."""
    place = i * FINER
    letter, exact_px = str(truth.exact.letters[place]), float(truth.exact.radii_px[place])
    seen_letter, px = str(seen.letters[i]), float(seen.radii_px[i])
    if exact_px < truth.nearest_px + NEAR_PX:
        return Cause.OWN_BODY
    if letter == seen_letter == WALL and _is_on_wall_line(i, px, truth):
        return Cause.WALL_LINE
    if _is_behind_ball(i, exact_px, truth):
        return Cause.BALL
    around = np.arange(place - FINER, place + FINER + 1) % len(truth.exact.letters)
    first_px, side_px, over_px = _rings(truth, around)
    if (np.abs(first_px - px) <= MAX_PLACE_PX)[truth.exact.letters[around] == seen_letter].any():
        return Cause.MODULE_PLACE
    if ((first_px - NEAR_PX <= px) & (px <= side_px + NEAR_PX)).any():
        return Cause.EDGE if at_edge else Cause.MODULE_SIDE
    if px > exact_px and truth.solids.solids[place] < 0:
        return Cause.BEYOND
    if (px >= over_px - NEAR_PX).any():
        return Cause.SEEN_OVER
    return Cause.UNEXPLAINED


def _rings(truth: Evidence, around: NDArray[np.intp]) -> tuple[Floats, Floats, Floats]:
    """Where the first objects of directions of the exact picture begin, where their sides end, and from where on
    something is seen over them; inf: never [px]."""
    px_from_mm, solids = truth.mirror.px_from_mm, truth.solids
    first = truth.exact.radii_px[around]
    low = np.isfinite(solids.face_end_mm[around])
    horizon = np.full(len(around), truth.mirror.horizon_px)
    side = np.where(low, px_from_mm(np.where(low, solids.face_end_mm[around], 0.0)), horizon)
    return first, side, np.where(low, side, np.inf)


def _is_on_wall_line(i: int, px: float, truth: Evidence) -> bool:
    """Whether what was seen in a direction lies on the line painted at the walls' feet."""
    venue, viewer = truth.scene.ground.venue, truth.scene.viewer
    line_m = truth.line_mm / MM_PER_M
    if not line_m or not math.isfinite(px):
        return False
    low, high = (truth.mirror.mm_from_px(px + slack) / MM_PER_M for slack in (-NEAR_PX, NEAR_PX))
    gap = math.inf
    angle = viewer[2] + math.radians(i)
    for distance in np.linspace(low, min(high, 1e3), 7):
        x, y = viewer[0] + distance * math.cos(angle), viewer[1] + distance * math.sin(angle)
        gap = min(gap, abs(min(venue.half_x - abs(x), venue.half_y - abs(y)) - line_m / 2.0))
    return gap <= line_m / 2.0


def _is_behind_ball(i: int, exact_px: float, truth: Evidence) -> bool:
    """Whether the ball hides the foot of what stands in a direction."""
    ball, radius_mm = truth.ball, float(truth.scene.ball[4]) * MM_PER_M
    height_mm = Hyperboloid.of(truth.mirror).height_mm
    aside = abs((i - ball.direction_deg + 180.0) % 360.0 - 180.0)
    if ball.share <= 0.0 or aside > ball.size_deg / 2.0 + WINDOW_DEG:
        return False
    first = truth.mirror.px_from_mm(max(ball.distance_mm - radius_mm, 0.0))
    last = truth.mirror.px_from_mm((ball.distance_mm + radius_mm) * height_mm / (height_mm - 2.0 * radius_mm))
    return first - NEAR_PX <= exact_px <= last + NEAR_PX
