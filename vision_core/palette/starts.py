"""First guesses of a palette: from the paints' names in many lights, and from things with the shape of markers."""

from collections.abc import Iterable, Sequence

import numpy as np

from vision_core.color.samples import Measured
from vision_core.geometry import Floats
from vision_core.palette.learn import bgr_from_chromaticity, floor_samples, without_colorless
from vision_core.palette.naming import Group, name_paints
from vision_core.palette.trial import Kind, Picture, Trial
from vision_core.settings.schema import SamplingSettings
from vision_core.types.colors import LUMA_BGR, chromaticity

FIRST = SamplingSettings(spread=0.2, tolerance=2.5)
"""How near a color must be to a guess."""
SCALES, SHIFTS = (0.35, 0.5, 0.8, 1.2), (-0.25, 0.0, 0.25)
"""How pure and how shifted paints may be, beside what their names say."""
PLAIN_SHARE = 0.02
"""A color that has so large a share of the field is floor."""
LIGHTEST = 0.98
"""The field's colors from this quantile of the luma on: lines and walls, which are white."""
PALE_LUMA = 160.0
"""Of a white or pale paint."""
NAMINGS, MIN_MARGIN, SAME = 12, 2.0, 0.1
"""So many of the best namings are taken, if they have a reading that is so sure and if they differ."""


def starts_for(trial: Trial, pictures: Sequence[Picture]) -> list[tuple[str, Measured]]:
    """Palettes to begin with, and where each comes from: "names" or "shapes"."""
    floor = np.concatenate([picture.floor_bgr for picture in pictures])
    lumas = floor @ LUMA_BGR
    grey = np.median(chromaticity(floor[lumas >= np.quantile(lumas, LIGHTEST)]), axis=0)
    carpet = np.median(chromaticity(floor), axis=0)
    plain = plain_colors(pictures)
    typical = chromaticity(trial.typical)
    by_name = [
        scale * typical + center + np.array([blue, red])
        for center in (np.zeros(2), grey)
        for scale in SCALES
        for blue in SHIFTS
        for red in SHIFTS
    ]
    by_shape = _by_shapes(trial, pictures, np.array([carpet, grey]))
    return [
        *(("names", palette_at(trial, means, plain)) for means in by_name),
        *(("shapes", palette_at(trial, means, plain)) for means in by_shape),
    ]


def plain_colors(pictures: Sequence[Picture]) -> Floats:
    """The colors that have a large share of the field, shape (n, 3)."""
    colors, shares = floor_samples(np.concatenate([picture.floor_bgr for picture in pictures]))
    found: Floats = colors[shares >= PLAIN_SHARE]
    return found


def palette_at(trial: Trial, means: Floats, plain: Floats) -> Measured:
    """The palette whose paints have some chromaticities, shape (paints, 2)."""
    colors = bgr_from_chromaticity(means)
    colors[trial.colorless] = bgr_from_chromaticity(means[trial.colorless], PALE_LUMA)
    classes = dict(zip(trial.paints, colors[:, None], strict=True))
    return Measured(classes, without_colorless(trial, plain, classes))


def _by_shapes(trial: Trial, pictures: Sequence[Picture], plain: Floats) -> list[Floats]:
    """Chromaticities of the paints, shape (paints, 2) each, under which things with the shape of markers are some."""
    groups = [
        Group([one for picture in pictures for one in trial.shapes(picture, kinds[0])], kinds)
        for kinds in _alike(trial.kinds)
    ]
    found: list[Floats] = []
    for naming in name_paints(groups, chromaticity(trial.typical), plain)[:NAMINGS]:
        is_sure = any(reading.margin >= MIN_MARGIN for reading in naming.readings)
        if is_sure and all(np.abs(naming.means - other).max() >= SAME for other in found):
            found.append(naming.means)
    return found


def _alike(kinds: Iterable[Kind]) -> list[list[Kind]]:
    """Kinds by their shape: often both teams wear the same pattern."""
    by_shape: dict[tuple[bytes, float], list[Kind]] = {}
    for kind in kinds:
        by_shape.setdefault(kind.shape, []).append(kind)
    return list(by_shape.values())
