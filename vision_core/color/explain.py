"""Why a color belongs to a class, and by how much it misses the others, in the units of the settings."""

from dataclasses import dataclass

import numpy as np

from vision_core.color.lookup_table import SPACES
from vision_core.color.samples import (
    claims_by_samples,
    distances,
    hex_from_bgr,
    measured_from,
    places_of,
    sampled_names,
)
from vision_core.geometry import Floats
from vision_core.settings.schema import ColorRange, ColorSettings

AXIS_LENGTHS = {"hue_deg": 180.0, "phase_deg": 180.0, "saturation": 1.0, "value": 1.0, "module": 181.0, "luma": 255.0}
"""Lengths of the axes of all spaces, to compare misses on different axes."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether one class claims a color, and if not, why."""

    name: str
    claims: bool
    why: str
    """On which axes the color misses the class's nearest box or sample, and by how much; empty when it claims it."""
    miss: float
    """Sum of the misses in shares of the axes' lengths, to order the classes by; 0 when it claims."""


def units_of(bgr: Floats, space: str) -> dict[str, float]:
    """One color in the axes of a space: shape (3,)."""
    convert, axes = SPACES[space]
    return dict(zip(axes, convert(bgr)[0].tolist(), strict=True))


def verdicts(bgr: Floats, colors: ColorSettings) -> list[Verdict]:
    """The verdict of every class on a color, the classes by ranges first; bgr: shape (3,)."""
    values = units_of(bgr, colors.space)
    found = []
    for name, boxes in colors.classes.items():
        misses = [_misses(box, values) for box in boxes]
        best = min(misses, key=lambda parts: sum(miss for miss, _ in parts), default=[(1.0, "it has no box")])
        found.append(Verdict(name, not best, ", ".join(text for _, text in best), sum(miss for miss, _ in best)))
    return [*found, *_by_samples(bgr, colors)]


def _misses(box: ColorRange, values: dict[str, float]) -> list[tuple[float, str]]:
    """The axes on which a color lies outside of a box: by which share of the axis, and in words."""
    parts = []
    for axis, value in values.items():
        if (bounds := getattr(box, axis)) is None:
            continue
        low, high = bounds
        if np.isnan(value):
            parts.append((1.0, f"{axis}: the color is too grey to have one (accepted: {low:g}..{high:g})"))
            continue
        by = _beyond(value, low, high, is_angle=axis.endswith("_deg"))
        if by > 0.0:
            parts.append((by / AXIS_LENGTHS[axis], f"{axis} {value:.4g} misses {low:g}..{high:g} by {by:.3g}"))
    return parts


def _beyond(value: float, low: float, high: float, *, is_angle: bool) -> float:
    """Distance of a value from an interval, 0 inside; intervals of angles [deg] may wrap."""
    if not is_angle:
        return max(low - value, value - high, 0.0)
    span = high - low if high >= low else high - low + 360.0
    ahead = (value - low) % 360.0
    return 0.0 if ahead <= span else min(ahead - span, 360.0 - ahead)


def _by_samples(bgr: Floats, colors: ColorSettings) -> list[Verdict]:
    """The verdicts of the classes by samples."""
    names = sampled_names(colors.samples)
    if not names:
        return []
    rows, measured, limit = bgr.reshape(1, 3), measured_from(colors.samples), colors.sampling.tolerance
    away = distances(rows, measured, colors.sampling)[0]
    claims = claims_by_samples(places_of(rows), measured, colors.sampling)
    nearest = names[int(away.argmin())]
    found = []
    for name, off in zip(names, away.tolist(), strict=True):
        if claims[name][0]:
            found.append(Verdict(name, True, "", 0.0))
            continue
        why = f"it is {off:.1f} spreads from the samples, more than sampling.tolerance = {limit:g}"
        if off <= limit:
            why = f"it is {off:.1f} spreads from the samples, but it agrees better with those of "
            why += nearest if nearest != name and claims[nearest][0] else "none, or of another class"
        found.append(Verdict(name, False, why, min(off, 100.0) / 100.0))
    return found


def in_words(bgr: Floats) -> str:
    """A color in the units of all spaces, on one line."""
    parts = [f"bgr {' '.join(f'{level:.0f}' for level in bgr)} {hex_from_bgr(bgr.tolist())}"]
    for space in SPACES:
        values = ", ".join(
            f"{axis} {'none' if np.isnan(value) else format(value, '.3g')}"  # grey has no hue
            for axis, value in units_of(bgr, space).items()
        )
        parts.append(f"{space}: {values}")
    return " | ".join(parts)
