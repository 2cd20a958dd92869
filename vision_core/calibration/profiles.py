"""Sub-pixel edges of painted lines: brightness profiles across their sections.

A section's profile is the mean of several cuts across the line. Paint is where the profile is brighter than what lies
beside it on both sides. From its brightest place outward, an edge is where the profile falls below half of the step.
The middle between both edges is free of any blur or width of the paint. Of a line that is hardly wider than a pixel the
centroid of the paint is taken, which does not depend on where the line lies between the pixels. A line along a wall has
one edge with carpet beside it, which is corrected by the median excess of width of the lines that show both edges. The
wall may even be as bright as the paint: then the step from carpet to paint counts as it is.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.calibration.painted import Placed
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.types.colors import LUMA_BGR

STEP_PX = 0.5
BESIDE_PX = 2.0
"""Carpet is looked at this far beyond a line's edge."""
MIN_CONTRAST = 10.0
"""Between paint and what lies beside it, on both sides [grey levels]."""
MIN_STEP = 30.0
"""Between paint or wall and carpet, where a single step is enough [grey levels]."""
MIN_SIDE = 0.6
"""An edge counts if its step is at least this share of that of the other edge."""
MAX_WIDTH_ERROR, MAX_WIDTH_ERROR_PX = 0.35, 1.6
"""Both edges belong to one line when their distance differs from its width by no more than this."""
MAX_WIDER_PX, MIN_AGREEING, AS_SAID = 4.0, 12, 0.5
"""Lines may all be so much wider than the settings say, when so many sections show it and most are not as said."""
WIDEST = 0.25
"""A line that would be wider than twice this share of the picture is none: the lens that says so has gone astray."""
THIN_PX = 1.3
"""Lines of at most this width are measured by their centroid."""
EDGE_REACH, STEEPEST = 15, 200
"""Half the width [px] of the surroundings of a steep place, and how many of the steepest places are looked at."""
FAR = 0.5
"""Share of its contrast that paint at the end of the reach loses against paint at its predicted place."""

FloatImage = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """What the profiles of sections say."""

    offset_px: Floats
    """Distance of the line's middle from its place, along the normal; nan where no paint was found. Shape (n,)."""
    single: NDArray[np.int8]
    """0: both edges were seen; 1 or -1: only the one in the direction of the normal, or against it. Shape (n,)."""
    excess_px: float
    """How much farther from the middle an edge lies than it should: blur, glare and the true width of the paint."""
    contrast: Floats
    """Paint over carpet [grey levels], shape (n,)."""
    rise_px: float
    """Median length of an edge, from carpet to paint; nan where none was found."""

    @property
    def found(self) -> Mask:
        """Sections that show paint."""
        found: Mask = np.isfinite(self.offset_px)
        return found


def luma_of(pixels: Bytes) -> FloatImage:
    """Brightness of a picture, shape (height, width, 3) -> (height, width)."""
    luma: FloatImage = (pixels @ LUMA_BGR).astype(np.float32)
    return luma


def sharpest_edge_px(luma: FloatImage) -> float:
    """How long the sharpest edges of a picture are, from dark to bright: 2 to 4 px in a focused one [px].

    luma: shape (height, width). The steepest places in columns and rows are looked at; a picture without any gives inf.
    """
    lengths = []
    for picture in (luma, luma.T):
        slopes = np.abs(np.diff(picture, axis=1))[:, EDGE_REACH:-EDGE_REACH]
        steepest = np.argpartition(slopes.ravel(), -STEEPEST)[-STEEPEST:]
        rows, columns = np.unravel_index(steepest, slopes.shape)
        around = picture[rows[:, None], columns[:, None] + np.arange(2 * EDGE_REACH + 1)]
        slope = slopes[rows, columns]
        lengths.append(np.where(slope > 0.0, np.ptp(around, axis=1) / np.maximum(slope, 1e-9), np.inf))
    return float(np.median(np.concatenate(lengths)))


def find_edges(luma: FloatImage, sections: Placed, reach_px: float, *, steps: bool = False) -> Edges:
    """Search the paint of sections up to reach_px beside their places.

    steps: of lines along walls, a single step from carpet to paint and wall is enough.
    """
    with np.errstate(invalid="ignore"):
        sane = sections.half_px <= WIDEST * max(luma.shape)
    half = np.where(sane, sections.half_px, 1.0)
    limit = reach_px + 2.0 * half.max(initial=0.0) + MAX_WIDER_PX + 2.0
    offsets = np.arange(-np.ceil(limit / STEP_PX), np.ceil(limit / STEP_PX) + 1.0) * STEP_PX
    profiles = _profiles(luma, sections, offsets)
    start, contrast = _brightest(profiles, half, offsets, reach_px)
    sides = [_edge(profiles[:, ::side], start if side == 1 else len(offsets) - 1 - start, half) for side in (1, -1)]
    (right, right_carpet, right_step, right_slope), (left, left_carpet, left_step, left_slope) = sides
    middle, width = (right - left) / 2.0, right + left
    step = np.fmax(right_step, left_step)
    is_right, is_left = (
        side_step >= np.maximum(MIN_SIDE * step, MIN_CONTRAST) for side_step in (right_step, left_step)
    )
    usable = sane & (contrast >= MIN_CONTRAST)
    both = usable & is_right & is_left
    wider = width - 2.0 * half
    limits = np.maximum(MAX_WIDTH_ERROR * 2.0 * half, MAX_WIDTH_ERROR_PX)
    both &= np.abs(wider - _usual(wider[both], limits[both])) <= limits
    excess = float(np.median(width[both] / 2.0 - half[both])) if both.any() else 0.0
    single = np.where(usable & ~both & is_right & ~is_left, 1, np.where(usable & ~both & is_left & ~is_right, -1, 0))
    thin = both & (2.0 * half <= THIN_PX)
    middle[thin] = _centroids(profiles[thin], middle[thin], half[thin], offsets, left_carpet[thin], right_carpet[thin])
    offset = np.where(both, middle, np.nan)
    offset = np.where(single == 1, right - half - excess, offset)
    offset = np.where(single == -1, -(left - half - excess), offset)
    for side in (1, -1) if steps else ():
        own = np.flatnonzero(sane & np.isnan(offset) & (sections.inward == side))
        offset[own] = side * _step(profiles[own, ::side], half[own], offsets, reach_px)
        single[own] = side
    offset = np.where(np.abs(offset) <= reach_px, offset, np.nan)
    slopes = np.concatenate([(right_step / right_slope)[both], (left_step / left_slope)[both]])
    rise = float(np.median(slopes)) if len(slopes) else np.nan
    return Edges(offset, single.astype(np.int8), excess, contrast, rise)


def _profiles(luma: FloatImage, sections: Placed, offsets: Floats) -> Floats:
    """Mean brightness across sections, shape (n, len(offsets)); nan where a section leaves the picture."""
    places = sections.points_px[:, :, None] + sections.normals[:, None, None] * offsets[:, None]
    profiles: Floats = sampled(luma, places).mean(axis=1)
    return profiles


def sampled(luma: FloatImage, places_px: Floats) -> Floats:
    """Brightness at places between the pixels, bilinear: shape (..., 2) [px] -> (...); nan outside of the picture."""
    height, width = luma.shape
    x, y = places_px[..., 0], places_px[..., 1]
    with np.errstate(invalid="ignore"):
        inside = (x >= 0.0) & (y >= 0.0) & (x <= width - 1.0) & (y <= height - 1.0)
    x, y = np.where(inside, x, 0.0), np.where(inside, y, 0.0)
    left, top = np.minimum(x.astype(np.intp), width - 2), np.minimum(y.astype(np.intp), height - 2)
    dx, dy = (x - left).astype(np.float32), (y - top).astype(np.float32)
    first = top * width + left
    flat = luma.ravel()
    upper = flat[first] * (1.0 - dx) + flat[first + 1] * dx
    lower = flat[first + width] * (1.0 - dx) + flat[first + width + 1] * dx
    values: Floats = np.where(inside, upper * (1.0 - dy) + lower * dy, np.nan)
    return values


def _brightest(profiles: Floats, half: Floats, offsets: Floats, reach_px: float) -> tuple[NDArray[np.intp], Floats]:
    """Where each profile shows paint most clearly, as an index of offsets, and how much brighter it is there."""
    columns = np.arange(len(offsets))
    aside = np.ceil((half + BESIDE_PX) / STEP_PX).astype(np.intp)[:, None]
    low, high = np.maximum(columns - aside, 0), np.minimum(columns + aside, len(offsets) - 1)
    beside = np.maximum(np.take_along_axis(profiles, low, 1), np.take_along_axis(profiles, high, 1))
    over = profiles - beside
    weight = 1.0 - FAR * np.minimum(np.abs(offsets) / max(reach_px, STEP_PX), 1.0) ** 2
    score = np.where((np.abs(offsets) <= reach_px) & np.isfinite(over), over * weight, -np.inf)
    best = score.argmax(axis=1)
    contrast = np.take_along_axis(over, best[:, None], 1)[:, 0]
    return best, np.where(np.isfinite(contrast), contrast, -np.inf)


def _usual(wider: Floats, limits: Floats) -> float:
    """How much wider all lines are than the settings say [px], by the sections with two edges.

    0 where most of them are as wide as they should be, or too few agree.
    """
    near = wider[np.abs(wider) <= MAX_WIDER_PX]
    is_as_said = (np.abs(wider) <= limits).sum() >= AS_SAID * len(near)
    return 0.0 if is_as_said or len(near) < MIN_AGREEING else float(np.median(near))


def _step(profiles: Floats, half: Floats, offsets: Floats, reach_px: float) -> Floats:
    """How far beside its place lies the step from the paint down to the carpet on its right? Shape (n,) [px]."""
    beside = offsets - half[:, None]
    bright = np.where((beside < 0.0) & (beside >= -2.0 * half[:, None] - BESIDE_PX - reach_px), profiles, -np.inf).max(
        axis=1
    )
    dark = np.where((beside > 0.0) & (beside <= reach_px + BESIDE_PX), profiles, np.inf).min(axis=1)
    with np.errstate(invalid="ignore"):
        level = ((bright + dark) / 2.0)[:, None]
        falls = (profiles[:, :-1] >= level) & (profiles[:, 1:] < level) & (np.abs(beside[:, :-1]) <= reach_px + STEP_PX)
        share = (profiles[:, :-1] - level) / np.maximum(profiles[:, :-1] - profiles[:, 1:], 1e-9)
        is_step = (bright - dark >= MIN_STEP) & (falls.sum(axis=1) == 1)
    place = np.where(falls, beside[:, :-1] + share * STEP_PX, 0.0).sum(axis=1)
    step: Floats = np.where(is_step, place, np.nan)
    return step


def _centroids(profiles: Floats, middle: Floats, half: Floats, offsets: Floats, left: Floats, right: Floats) -> Floats:
    """Centroids of the paint near middles, over the carpet's levels on the left and on the right; shape (n,) [px]."""
    beside = offsets - middle[:, None]
    reach = (half + 1.0)[:, None]
    carpet = left[:, None] + (right - left)[:, None] * np.clip(beside / reach / 2.0 + 0.5, 0.0, 1.0)
    weights = np.clip(reach + 0.5 - np.abs(beside), 0.0, 1.0) * (np.nan_to_num(profiles) - carpet)
    centroids: Floats = middle + (weights * beside).sum(axis=1) / np.maximum(weights.sum(axis=1), 1e-9)
    return centroids


def _edge(profiles: Floats, start: NDArray[np.intp], half: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """The first edge from start on, to the right.

    Returns its offset from the profile's middle [px], the carpet's level beside it, its step, its slope; shape (n,).
    """
    length = profiles.shape[1]
    reach = np.ceil((2.0 * half + MAX_WIDER_PX) / STEP_PX).astype(np.intp)
    steps = np.arange(reach.max(initial=1) + 1)
    index = np.minimum(start[:, None] + steps, length - 1)
    cut = np.take_along_axis(profiles, index, 1)
    cut = np.where((steps <= reach[:, None]) & (start[:, None] + steps < length), cut, np.nan)
    with np.errstate(invalid="ignore"):
        paint, carpet = cut[:, 0], np.fmin.reduce(cut, axis=1)
        below = cut < ((paint + carpet) / 2.0)[:, None]
    last = np.maximum(below.argmax(axis=1), 1)[:, None]
    before, after = np.take_along_axis(cut, last - 1, 1)[:, 0], np.take_along_axis(cut, last, 1)[:, 0]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = (before - (paint + carpet) / 2.0) / (before - after)
    place = (start + last[:, 0] - 1 + share - (length - 1) / 2.0) * STEP_PX
    place = np.where(below.any(axis=1), place, np.nan)
    step = np.where(np.isfinite(place), paint - carpet, -np.inf)
    return place, carpet, step, np.maximum((before - after) / STEP_PX, 1e-9)
