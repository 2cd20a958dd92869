"""The nearest edge along every ray, and its type, by color and radial search."""

import numpy as np
from numpy.typing import NDArray

from vision_core.client.recognition.geometry import PictureGeometry, ray_radii_px
from vision_core.client.recognition.palette import Palette, Surface
from vision_core.client.recognition.runs import (
    Counts,
    crossings,
    ends_of_runs,
    sums_before,
    widths_around,
    without_gaps,
)
from vision_core.geometry import Bytes, Floats, Mask

NOTHING, WALL, GOAL_BLUE, GOAL_YELLOW = "-", "w", "u", "v"
BLUE, YELLOW, ROBOT, OBSTACLE = "x", "y", "r", "q"
"""Letters of edges, those of ``(types team)``; a robot whose team nobody can tell is one of ``(types same)``."""
LETTERS = {
    Surface.WALL: WALL,
    Surface.GOAL_BLUE: GOAL_BLUE,
    Surface.GOAL_YELLOW: GOAL_YELLOW,
    Surface.BLUE: BLUE,
    Surface.YELLOW: YELLOW,
    Surface.DARK: ROBOT,
    Surface.OBSTACLE: OBSTACLE,
    Surface.OTHER: OBSTACLE,
}
GOAL_OF_ROBOT = {BLUE: GOAL_BLUE, YELLOW: GOAL_YELLOW}
"""Where robots have dark feet, the color of a team's robots is that of its goal."""
MIN_RUN_PX = 2.0
"""What is shorter along a ray, in pixels of the picture, and has floor behind it, is noise or a blurred border."""
BALL_BLUR_PX = 3.5
"""An edge whose beginning is so near behind the ball is covered by it, or its place is blurred."""
MIN_END_PX = 1.0
"""The same at the end of a ray, where the rim begins."""
MIN_FLOOR_PX = 1.0
"""More floor than this behind something white makes it a line; less is none, as two colors may mix to the floor's."""
LINE_MM, LINE_BLUR_PX = 35.0, 3.0
"""A line is at most so wide on the floor; in the picture, in pixels of it, blur is added."""
START_PX, FLAT_START_PX = 3.0, 6.0
"""The type is what most samples of an edge's beginning show, so much of it in the picture; FLAT: where robots have one
color, and what follows is no other part of them."""
BLUR_PX, BLUR_WEIGHT = 1.0, 0.4
"""The first samples may be mixed with the floor and count less."""
FOOT_PX = 1.5
"""So much of a dark beginning, in pixels of the picture, is a robot's body."""
BAND_PX = 1.0
"""So much of a team's color above it is its band."""

TEAM_REACH, TEAM_STEP = 4, 0.15
"""A robot's ray that meets no band is of the team of a robot so many rays aside whose radius is no more different."""


def find_edges(
    rays: Bytes, labels: Bytes, geometry: PictureGeometry, palette: Palette
) -> tuple[NDArray[np.str_], Floats]:
    """Letter and exact radius [px of equation 1; inf: nothing] of the nearest edge of every ray, shape (n,).

    rays: blue green red of samples at ``ray_radii_px``, shape (n, m, 3); labels: their Surface, shape (n, m).
    """
    radii = ray_radii_px(geometry)
    per_px = 1.0 / ((radii[1] - radii[0]) * geometry.scale)
    """Samples per pixel of the picture."""
    solid = (labels != Surface.FLOOR) & (labels != Surface.BALL) & ~_lines(labels, geometry, per_px)
    blocked = without_gaps(solid, round(MIN_FLOOR_PX * per_px))
    ends = ends_of_runs(blocked)
    starts = blocked.copy()
    starts[:, 1:] &= ~blocked[:, :-1]
    lengths = ends - np.arange(labels.shape[1])
    at_end = (ends == labels.shape[1]) & (lengths > MIN_END_PX * per_px)
    starts &= (lengths >= MIN_RUN_PX * per_px) | at_end
    first = np.argmax(starts, axis=1)
    found = starts.any(axis=1)
    rows = np.arange(len(labels))
    letters, settled = _types(labels, first, ends[rows, first], palette, per_px)
    letters[~found] = NOTHING
    place = crossings(rays, first, settled, blur=round(1.5 * per_px))
    exact = radii[0] + np.maximum(place, 0.0) * (radii[1] - radii[0])
    exact[~found] = np.inf
    before = first[:, None] - 1 - np.arange(round(BALL_BLUR_PX * per_px))
    is_ball = np.take_along_axis(labels, np.maximum(before, 0), axis=1) == Surface.BALL
    return _with_teams(letters, exact), _bridged(exact, letters, found & is_ball.any(axis=1))


def _lines(labels: Bytes, geometry: PictureGeometry, per_px: float) -> Mask:
    """Which samples show a line: a white run, narrow along the ray or across it, with floor or a robot's foot behind.

    A wall is wide both ways, and nothing of the field is seen behind it.
    """
    n, m = labels.shape
    rows = np.arange(n)[:, None]
    white = without_gaps(labels == Surface.WALL, 1)
    ends = ends_of_runs(white)
    behind = np.zeros_like(white)
    for surface, least_px in ((Surface.FLOOR, MIN_FLOOR_PX), (Surface.DARK, FOOT_PX)):
        stretch = ends_of_runs(np.pad(labels == surface, ((0, 0), (0, 1))))
        behind |= stretch[rows, ends] - ends > least_px * per_px
    radii = ray_radii_px(geometry)
    mm = geometry.mirror.mm_from_px(radii)
    with np.errstate(invalid="ignore", divide="ignore"):
        along_limit = LINE_MM / np.nan_to_num(np.gradient(mm), nan=np.inf) + LINE_BLUR_PX * per_px
        across_limit = LINE_MM / mm * radii + LINE_BLUR_PX / geometry.scale
    first = white & ~np.pad(white, ((0, 0), (1, 0)))[:, :-1]
    since = np.maximum.accumulate(np.where(first, np.arange(m), 0), axis=1)
    whole = ends - since
    across = widths_around(white) * radii * (2.0 * np.pi / n)
    narrow = sums_before(white & (across <= across_limit))
    narrow_share = (narrow[rows, ends] - narrow[rows, since]) / np.maximum(whole, 1)
    return np.asarray(white & behind & ((whole <= along_limit) | (narrow_share >= 0.5)))


def _types(
    labels: Bytes, first: Counts, ends: Counts, palette: Palette, per_px: float
) -> tuple[NDArray[np.str_], Counts]:
    """Letter of each ray's edge, by what its run shows, and the first sample that shows it; shapes (n,)."""
    columns = first[:, None] + np.arange(round((START_PX if palette.dark_feet else FLAT_START_PX) * per_px))
    start = np.take_along_axis(labels, np.minimum(columns, labels.shape[1] - 1), axis=1)
    start[columns >= ends[:, None]] = Surface.OTHER
    kinds = np.array([surface for surface in LETTERS if surface is not Surface.OTHER])
    weights = np.where(np.arange(start.shape[1]) < BLUR_PX * per_px, BLUR_WEIGHT, 1.0)
    counts = np.stack([(start == surface) @ weights for surface in kinds])
    shown = np.where(counts.max(axis=0) > 0.0, kinds[counts.argmax(axis=0)], Surface.OTHER)
    letters = np.array([LETTERS.get(surface, NOTHING) for surface in Surface])[shown]
    if palette.dark_feet:
        for robot, goal in GOAL_OF_ROBOT.items():
            letters[letters == robot] = goal
        is_robot = (start == Surface.DARK).sum(axis=1) >= FOOT_PX * per_px
        letters = np.where(is_robot, _team(labels, first, ends, per_px), letters)
        shown = np.where(is_robot, Surface.DARK, shown)
    return letters, first + (start == shown[:, None]).argmax(axis=1)


def _team(labels: Bytes, first: Counts, ends: Counts, per_px: float) -> NDArray[np.str_]:
    """The letter of the first team's color in each run; ROBOT without one."""
    columns = np.arange(labels.shape[1])
    inside = (columns >= first[:, None]) & (columns < ends[:, None])
    places = []
    for surface in (Surface.BLUE, Surface.YELLOW):
        colored = (labels == surface) & inside
        band = colored & (ends_of_runs(colored) - columns >= BAND_PX * per_px)
        places.append(np.where(band.any(axis=1), band.argmax(axis=1), len(columns)))
    blue, yellow = places
    return np.where(np.minimum(blue, yellow) == len(columns), ROBOT, np.where(blue < yellow, BLUE, YELLOW))


def _with_teams(letters: NDArray[np.str_], radii: Floats) -> NDArray[np.str_]:
    """The letters, where a robot's ray that meets no band has its team from the nearest ray that does."""
    told = letters.copy()
    for away in range(1, TEAM_REACH + 1):
        for shift in (away, -away):
            from_there, there = np.roll(letters, shift), np.roll(radii, shift)
            team = (from_there == BLUE) | (from_there == YELLOW)
            with np.errstate(invalid="ignore"):
                same = np.abs(there - radii) <= TEAM_STEP * radii
            told = np.where((told == ROBOT) & team & same, from_there, told)
    return told


def _bridged(radii: Floats, letters: NDArray[np.str_], covered: Mask) -> Floats:
    """The radii, where the ball covers an edge's beginning interpolated between its nearest uncovered neighbors.

    If only one of them is of the same type, the radius is that neighbor's; if none is, it is where the ball ends.
    """
    known = np.flatnonzero(~covered & np.isfinite(radii))
    hidden = np.flatnonzero(covered)
    if not len(known) or not len(hidden):
        return radii
    n = len(radii)
    ring = np.concatenate([known - n, known, known + n])
    after = np.searchsorted(ring, hidden)
    left, right = ring[after - 1], ring[after]
    share = (hidden - left) / (right - left)
    left, right = left % n, right % n
    left_alike, right_alike = letters[left] == letters[hidden], letters[right] == letters[hidden]
    share = np.where(left_alike & right_alike, share, np.where(right_alike, 1.0, 0.0))
    bridged = radii.copy()
    between = (1.0 - share) * radii[left] + share * radii[right]
    bridged[hidden] = np.where(left_alike | right_alike, between, radii[hidden])
    return bridged
