"""Moves a first guess of the camera onto the lines: by shifts, turns and scales, then by ever narrower searches."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from vision_core.calibration.lens import CENTER, DISTORTION, FOCAL, HEIGHT, MEASURES, STRETCH, Lens
from vision_core.calibration.painted import Painted, placed
from vision_core.calibration.profiles import FloatImage, find_edges
from vision_core.calibration.ridges import Ridges
from vision_core.calibration.solver import Fit, Prior, Sights, fit
from vision_core.geometry import Floats, Mask, rotation

TURNS_DEG = np.arange(-4.0, 4.1, 1.0)
SCALES = np.array([0.94, 0.97, 1.0, 1.03, 1.06])
REACH, STEP_PX, CAP_PX = 0.16, 5, 10.0
"""Shifts are tried up to this share of the picture's smaller side, in such steps; distances are capped [small px]."""
SHIFTED_POINTS = 120
WIDE, NEAR = ((24.0, 4.0), (16.0, 3.0), (10.0, 2.0)), ((8.0, 2.0), (6.0, 1.5), (4.0, 1.0), (4.0, 0.5))
"""Rounds of the search: how far beside their places lines are searched, and the deviation that counts as usual [px]; in
a picture over 800 px wide in proportion. In the wide ones the lens stays as it is, the pose alone moves."""
MIN_SIGHTS = 12
POSE_ONLY = 1e-3
"""Factor of the deviations of a lens that is to stay as it is."""


def shifted(lens: Lens, painted: Painted, ridges: Ridges, prior: Prior) -> Lens:
    """The lens after the similarity that brings the projected lines nearest to ridges."""
    seen = placed(painted, lens)
    middles = seen.points_px.mean(axis=1)
    usable = np.isfinite(middles).all(axis=1)
    points, normals, places = middles[usable], seen.normals[usable], painted.middles_m[usable]
    if len(points) < 3:
        return lens
    few = np.linspace(0, len(points) - 1, min(len(points), SHIFTED_POINTS)).round().astype(np.intp)
    center = (np.array(ridges.mask.shape[::-1]) / ridges.scale - 1.0) / 2.0
    reach = int(REACH * min(ridges.mask.shape)) // STEP_PX
    steps = np.arange(-reach, reach + 1) * STEP_PX
    shifts = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    best, moved = np.inf, points
    for turn, scale in product(np.radians(TURNS_DEG), SCALES):
        matrix = rotation(turn)
        tried = (points - center) @ matrix.T * scale + center
        errors = ridges.errors(tried[few], normals[few] @ matrix.T, shifts, CAP_PX)
        if (least := errors.min()) < best:
            best, moved = least, tried + shifts[errors.argmin()] / ridges.scale
    return fit_points(lens, places, moved, prior)


def fit_points(lens: Lens, places_m: Floats, pixels: Floats, prior: Prior) -> Lens:
    """The lens that shows floor points at pixels, as well as the prior allows."""
    count = len(places_m)
    along = np.tile([1.0, 0.0], (count, 1)), np.tile([0.0, 1.0], (count, 1))
    still = np.zeros((2 * count, 2, len(MEASURES)))
    sights = Sights(np.tile(places_m, (2, 1)), still, np.tile(pixels, (2, 1)), np.concatenate(along))
    return fit(lens, sights, prior, noise_px=1.0, steps=30).lens


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What one or more pictures by one camera say about the painted lines."""

    sights: Sights
    sections: NDArray[np.intp]
    """Index of each sight's section, shape (n,)."""
    is_step: Mask
    """Which sights are a single edge along a wall: it is the paint's, or the wall's where no paint lies. Shape (n,)."""
    rise_px: float
    """Median length of an edge from carpet to paint; nan where none was found."""


def look(painted: Painted, lens: Lens, lumas: Sequence[FloatImage], reach_px: float, *, singles: bool = True) -> Seen:
    """Search the paint of sections up to reach_px beside where the lens puts them, in every picture.

    Of a section that several pictures show, the median counts: what is wrong with the paint is wrong in all of them.

    singles: sections count of which only one edge has carpet beside it, and along walls mere steps.
    """
    placed_px = placed(painted, lens)
    seen = [find_edges(luma, placed_px, reach_px, steps=singles) for luma in lumas]
    shown = np.stack([edges.found & ((edges.single == 0) | singles) for edges in seen])
    sections = np.flatnonzero(shown.any(axis=0))
    several = np.where(shown, np.stack([edges.offset_px for edges in seen]), np.nan)[:, sections]
    offsets = np.nanmedian(several, axis=0)
    normals = placed_px.normals[sections]
    middles, moves = painted.middles_m[sections], painted.moves[sections]
    measured = lens.project(middles + moves @ lens.stretch) + normals * offsets[:, None]
    both: Mask = np.logical_or.reduce([edges.found & (edges.single == 0) for edges in seen])
    is_step = (painted.inward != 0)[sections] & ~both[sections]
    rises = [edges.rise_px for edges in seen if np.isfinite(edges.rise_px)]
    sights = Sights(middles, moves, measured, normals)
    return Seen(sights, sections, is_step, float(np.median(rises)) if rises else np.nan)


def searched(lens: Lens, painted: Painted, lumas: Sequence[FloatImage], prior: Prior, *, wide: bool) -> Fit | None:
    """The lens after rounds of searching the lines nearer and nearer to their places; None: too few are found.

    wide: begin far beside the lines' places.
    """
    scale = max(max(lumas[0].shape) / 800.0, 1.0)
    result = None
    pose = posed(prior, lens)
    for number, (reach_px, noise_px) in enumerate((*(WIDE if wide else ()), *NEAR)):
        sights = look(painted, lens, lumas, reach_px * scale, singles=False).sights
        if len(sights) < MIN_SIGHTS:
            return None
        known = pose if number <= len(WIDE) * wide else prior
        result = fit(lens, sights, known, noise_px=noise_px * scale)
        lens = result.lens
    return result


def posed(prior: Prior, lens: Lens) -> Prior:
    """A prior that moves the pose alone and leaves the lens as it is."""
    deviations, values = prior.deviations.copy(), lens.values
    deviations[FOCAL] *= POSE_ONLY
    deviations[CENTER] *= POSE_ONLY
    deviations[DISTORTION] *= POSE_ONLY
    deviations[STRETCH] *= POSE_ONLY
    values[HEIGHT] = prior.values[HEIGHT]
    return Prior(values, deviations, prior.counts)
