"""Ranges in a color space, and samples -> one table over all quantized colors."""

from collections.abc import Collection
from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from vision_core.color.references import references_of
from vision_core.color.samples import (
    Measured,
    Places,
    claims_by_samples,
    measured_from,
    places_of,
    references_from,
    sampled_names,
)
from vision_core.color.spaces import ec_from_bgr, hsv_from_bgr, ymp_from_bgr
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, Floats, Mask, frozen
from vision_core.settings.schema import ColorRange, ColorSettings, SamplingSettings
from vision_core.types.colors import CELL_COUNT, CELL_SIZE_BGR, ColorTable, References, cell_corner

SPACES = {
    "hsv": (hsv_from_bgr, ("hue_deg", "saturation", "value")),
    "ec": (ec_from_bgr, ("luma", "hue_deg", "saturation")),
    "ymp": (ymp_from_bgr, ("luma", "module", "phase_deg")),
}

ALL_CELLS: NDArray[np.int64] = frozen(np.arange(CELL_COUNT))
MAX_CLASSES = 255
"""Class numbers are bytes, and 0 is no class."""


def compile_color_table(colors: ColorSettings) -> ColorTable:
    """Judge every cell by its center. Where classes claim the same cell, the one listed first gets it; classes by
    samples come after those by ranges. Raises SettingsError for more than MAX_CLASSES classes."""
    names = {*colors.classes, *sampled_names(colors.samples)}
    if len(names) > MAX_CLASSES:
        raise SettingsError("colors: number of color classes", found=str(len(names)), accepted=f"at most {MAX_CLASSES}")
    convert, axes = SPACES[colors.space]
    cells = cell_centers()
    coordinates = dict(zip(axes, convert(cells).T, strict=True))
    claims = {name: _claim(boxes, coordinates) for name, boxes in colors.classes.items()}
    measured = measured_from(colors.samples)
    claims |= claims_by_samples(_places_of_cells(), measured, colors.sampling)
    classes = np.zeros(CELL_COUNT, dtype=np.uint8)
    for number, claim in reversed(list(enumerate(claims.values(), start=1))):
        classes[claim] = number
    means = [
        cells[classes == number].mean(axis=0) if (classes == number).any() else np.full(3, 127.0)
        for number in range(len(claims) + 1)
    ]
    overlaps = [(one, other, int((claims[one] & claims[other]).sum())) for one, other in combinations(claims, 2)]
    return ColorTable(
        names=("", *claims),
        classes=frozen(classes),
        mean_bgr=frozen(np.array(means).round().astype(np.uint8)),
        disputed=tuple(overlap for overlap in overlaps if overlap[2]),
        references=_references(classes, cells, len(colors.classes), measured, colors.sampling.spread),
    )


def compile_samples(measured: Measured, sampling: SamplingSettings, cells: NDArray[np.int64] = ALL_CELLS) -> ColorTable:
    """The table of classes by samples alone.

    cells: those that are needed; the others get no class, which is quicker when pictures have few colors.
    """
    places = _places_of_cells()
    claims = claims_by_samples(Places(places.chroma[cells], places.luma[cells]), measured, sampling)
    classes = np.zeros(CELL_COUNT, dtype=np.uint8)
    for number, claim in enumerate(claims.values(), start=1):
        classes[cells[claim]] = number
    means = [np.full(3, 127.0), *(colors.mean(axis=0) for colors in measured.classes.values())]
    return ColorTable(
        names=("", *claims),
        classes=frozen(classes),
        mean_bgr=frozen(np.clip(means, 0.0, 255.0).round().astype(np.uint8)),
        disputed=(),
        references=_references(classes, cell_centers(), 0, measured, sampling.spread),
    )


def _references(classes: Bytes, cells: Floats, by_ranges: int, measured: Measured, spread: float) -> References:
    """What the classes look like: those by ranges by their cells, those by samples by these."""
    ranged, sampled = references_of(classes, cells, 1 + by_ranges), references_from(measured, spread)
    means = np.concatenate([ranged.means, sampled.means])
    return References(frozen(means), frozen(np.concatenate([ranged.spreads, sampled.spreads])))


def keep_classes(table: ColorTable, names: Collection[str]) -> ColorTable:
    """The same table without all other classes: colors that are not searched need not become blobs."""
    kept = np.array([name in names for name in table.names])
    return replace(table, classes=frozen(np.where(kept[table.classes], table.classes, 0).astype(np.uint8)))


@cache
def cell_centers() -> Floats:
    """Blue green red at the middle of every cell of the table, in its order, shape (65536, 3)."""
    corner = np.column_stack(cell_corner(ALL_CELLS))
    centers: Floats = frozen(corner + (np.array(CELL_SIZE_BGR) - 1) / 2.0)
    return centers


@cache
def _places_of_cells() -> Places:
    return places_of(cell_centers())


def _claim(boxes: tuple[ColorRange, ...], coordinates: dict[str, Floats]) -> Mask:
    """Which cells lie in one of the boxes, shape (65536,)."""
    claim = np.zeros(CELL_COUNT, dtype=np.bool_)
    for box in boxes:
        inside = np.ones(CELL_COUNT, dtype=np.bool_)
        for axis, values in coordinates.items():
            if (bounds := getattr(box, axis)) is not None:
                inside &= _within(values, *bounds, is_angle=axis.endswith("_deg"))
        claim |= inside
    return claim


def _within(values: Floats, low: float, high: float, *, is_angle: bool) -> Mask:
    if is_angle:
        return np.asarray((values - low) % 360.0 <= (high - low if high >= low else high - low + 360.0))
    return np.asarray((low <= values) & (values <= high))
