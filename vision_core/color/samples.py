"""Classes by samples: how well a color agrees with the measured colors of each class.

A class is a *reference color with its spread*: the mean and the covariance of its samples' chromaticities
(``types.colors.chromaticity``), which half the light does not change. A class of few samples has the spread that the
settings give. Glare draws a paper's color towards grey, so every class reaches farther in that direction. Colors much
darker than the darkest sample agree less.

Samples of what is *not* searched (carpet, lines, robots' bodies) are listed under ``none``. Each of them claims the
colors near to it, also in brightness: a dark green carpet and a bright green paper have the same chromaticity.

The agreement is a log density; the class with the highest one gets the color, unless a sample of ``none`` has a higher
one, or the color lies farther from the class than ``sampling.tolerance`` of its spreads.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Floats, Mask
from vision_core.native.kernels import kernel
from vision_core.settings.schema import SamplingSettings
from vision_core.types.colors import DARK_LEVEL, LUMA_BGR, References, chromaticity

NONE = "none"
"""Name of the list of samples that have no class."""
PRIOR_COUNT = 2.0
"""Samples that the spread of the settings counts for."""
LEVEL_SD = 4.0
"""How far prints, lamps and sensors differ in each channel [grey levels], beside the spread."""
FADE = 0.25
"""Deviation of a class towards grey, as a share of its distance from grey."""
LIGHT_LUMA = 120.0
"""The lightest sample of ``none`` from this luma on is what grey looks like; without one it is equal channels."""
DARKEST_SHARE, DARKNESS_SD = 0.45, 0.2
"""Colors darker than this share of a class's darkest sample agree less; deviation of the luma's logarithm."""
NONE_SD, NONE_LUMA_SD = 0.1, 0.18
"""Deviations round a sample of ``none``: of chromaticity, and of the luma's logarithm."""
NONE_ADVANTAGE = 4.0
"""Log density that a sample of ``none`` has beyond a class: most of a picture is floor."""
DARK_LUMA = 4.0
"""Added to lumas before their logarithm is taken."""


class Measured(NamedTuple):
    """The measured colors of a palette: blue, green, red."""

    classes: Mapping[str, Floats]
    """Of every class, shape (n, 3)."""
    none: Floats
    """Of what has no class, shape (n, 3)."""


def hex_from_bgr(bgr: Sequence[float]) -> str:
    """A color as "#rrggbb"."""
    blue, green, red = (min(max(round(level), 0), 255) for level in bgr)
    return f"#{red:02x}{green:02x}{blue:02x}"


def bgr_from_hex(text: str) -> tuple[int, int, int]:
    """Blue green red of "#rrggbb"."""
    return int(text[5:7], 16), int(text[3:5], 16), int(text[1:3], 16)


def sampled_names(samples: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """The classes that have samples, in their order."""
    return tuple(name for name in samples if name != NONE)


def measured_from(samples: Mapping[str, Sequence[str]]) -> Measured:
    """The samples of settings as numbers."""
    colors = {
        name: np.array([bgr_from_hex(text) for text in texts], dtype=np.float64).reshape(-1, 3)
        for name, texts in samples.items()
    }
    none = colors.pop(NONE, np.zeros((0, 3)))
    return Measured(colors, none)


def references_from(measured: Measured, spread: float) -> References:
    """Mean and covariance of every class; spread: of a class of few samples. A class without samples is at grey."""
    grey = _grey_of(measured.none)
    means, spreads = np.zeros((len(measured.classes), 2)), np.zeros((len(measured.classes), 3))
    for number, colors in enumerate(measured.classes.values()):
        places = chromaticity(colors)
        mean = np.median(places, axis=0) if len(places) else grey
        off = places - mean
        covariance = (off.T @ off + PRIOR_COUNT * spread**2 * np.eye(2)) / (len(places) + PRIOR_COUNT)
        covariance += _noise_of(colors)
        fade = FADE * (grey - mean)
        covariance += np.outer(fade, fade)
        means[number] = mean
        spreads[number] = covariance[0, 0], covariance[0, 1], covariance[1, 1]
    return References(means, spreads)


class Places(NamedTuple):
    """Where colors lie."""

    chroma: Floats
    """Chromaticities, shape (n, 2)."""
    luma: Floats
    """Logarithms of the luma, shape (n,)."""


def places_of(bgr: Floats) -> Places:
    """Where colors lie: shape (n, 3)."""
    return Places(chromaticity(bgr), _log_luma(bgr))


def distances(bgr: Floats, measured: Measured, settings: SamplingSettings) -> Floats:
    """How far each color is from each class, in spreads of the class: shape (n, 3) -> (n, classes).

    Infinite for a class without samples.
    """
    off, _ = _judged(places_of(bgr), measured, settings)
    return np.sqrt(off)


def claims_by_samples(places: Places, measured: Measured, settings: SamplingSettings) -> dict[str, Mask]:
    """Which colors each class claims, per class shape (n,)."""
    if not measured.classes:
        return {}
    off, none = _judged(places, measured, settings)
    xx, xy, yy = references_from(measured, settings.spread).spreads.T
    density = -0.5 * off - 0.5 * np.log((xx * yy - xy * xy) / settings.spread**4)
    density[off > settings.tolerance**2] = -np.inf
    best = density.argmax(axis=1)
    claimed = density[np.arange(len(best)), best] > none
    return {name: claimed & (best == number) for number, name in enumerate(measured.classes)}


def _judged(places: Places, measured: Measured, settings: SamplingSettings) -> tuple[Floats, Floats]:
    """Squared distance of each color from each class in spreads, (n, classes); log density under ``none``, (n,)."""
    references = references_from(measured, settings.spread)
    xx, xy, yy = references.spreads.T
    inverse = np.column_stack([yy, -xy, xx]) / (xx * yy - xy * xy)[:, None]
    darkest = np.array([_log_luma(c).min() if len(c) else np.nan for c in measured.classes.values()])
    off, none = np.full((len(places.luma), len(darkest)), np.inf), np.full(len(places.luma), -np.inf)
    judge_places(
        places.chroma, places.luma, references.means, inverse, darkest + math.log(DARKEST_SHARE),
        *places_of(measured.none), off, none,
    )  # fmt: skip
    return off, none


@kernel
def judge_places(
    chroma: Floats, luma: Floats, means: Floats, inverse: Floats, darkest: Floats, none_chroma: Floats,
    none_luma: Floats, off: Floats, none: Floats,
) -> None:  # fmt: skip
    """Fill in ``off`` and ``none`` of ``_judged``. darkest: nan for a class without samples."""
    for row in range(len(luma)):
        for number in range(len(darkest)):
            if math.isnan(darkest[number]):
                continue
            x, y = chroma[row, 0] - means[number, 0], chroma[row, 1] - means[number, 1]
            darkness = max(darkest[number] - luma[row], 0.0) / DARKNESS_SD
            off[row, number] = (
                inverse[number, 0] * x * x + 2.0 * inverse[number, 1] * x * y + inverse[number, 2] * y * y
                + darkness * darkness
            )  # fmt: skip
        least = math.inf
        for number in range(len(none_luma)):
            x, y = (
                (chroma[row, 0] - none_chroma[number, 0]) / NONE_SD,
                (chroma[row, 1] - none_chroma[number, 1]) / NONE_SD,
            )
            z = (luma[row] - none_luma[number]) / NONE_LUMA_SD
            least = min(least, x * x + y * y + z * z)
        none[row] = NONE_ADVANTAGE - 0.5 * least


def _log_luma(bgr: Floats) -> Floats:
    return np.asarray(np.log(np.asarray(bgr, dtype=np.float64).reshape(-1, 3) @ LUMA_BGR + DARK_LUMA))


def _noise_of(colors: Floats) -> Floats:
    """Covariance of the chromaticity when every channel is off by LEVEL_SD: near black the ratios tell little."""
    if not len(colors):
        return np.zeros((2, 2))
    blue, green, red = (LEVEL_SD / (np.clip(np.median(colors, axis=0), 0.0, None) + DARK_LEVEL)) ** 2
    return np.array([[blue + green, green], [green, red + green]])


def _grey_of(none: Floats) -> Floats:
    """Chromaticity of what is grey."""
    if len(none) and (lumas := none @ LUMA_BGR).max() >= LIGHT_LUMA:
        return chromaticity(none[int(lumas.argmax())])
    return np.zeros(2)
