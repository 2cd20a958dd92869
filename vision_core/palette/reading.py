"""A palette, and what is read in pictures with it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vision_core.color.lookup_table import compile_samples
from vision_core.color.samples import Measured
from vision_core.palette.trial import Judged, Picture, Trial
from vision_core.settings.schema import SamplingSettings
from vision_core.types.colors import CELL_COUNT, ColorTable, cell_index

BETTER = 0.4
"""A palette must read more robots than the one in force, and score so much more: a fifth of one that is read."""


@dataclass(frozen=True, slots=True)
class Palette:
    """Colors, and what is read by them."""

    table: ColorTable
    """Of the paints in their order."""
    measured: Measured | None
    """What the table was made from; None: the settings' own colors."""
    sampling: SamplingSettings
    counts: NDArray[np.int64]
    """Patches from which each paint was learned, shape (paints,)."""
    score: float = 0.0
    """Sum over the pictures."""
    judged: tuple[Judged, ...] = ()
    """Of each picture."""

    @property
    def read(self) -> int:
        """How many robots are read in the pictures."""
        return sum(int((one.evidence > 0.0).sum()) for one in self.judged)

    def is_better_than(self, other: "Palette") -> bool:
        """Does it read more robots, and explain the pictures clearly better?"""
        return self.read > other.read and self.score > other.score + BETTER

    @property
    def learned(self) -> bool:
        """Was it learned from robots that were read?"""
        return bool(self.counts.any())


def judged_with(
    trial: Trial,
    pictures: Sequence[Picture],
    measured: Measured,
    sampling: SamplingSettings,
    cells: NDArray[np.int64],
    counts: NDArray[np.int64] | None = None,
) -> Palette:
    """What is read in pictures with some colors. cells: of ``cells_of`` these pictures; the table has no others."""
    none = np.zeros(len(trial.paints), dtype=np.int64)
    table = compile_samples(measured, sampling, cells)
    return judged_again(trial, pictures, Palette(table, measured, sampling, none if counts is None else counts))


def cells_of(pictures: Sequence[Picture]) -> NDArray[np.int64]:
    """The cells of the color table that pictures have, in ascending order."""
    is_there = np.zeros(CELL_COUNT, dtype=np.bool_)
    for picture in pictures:
        is_there[cell_index(*np.moveaxis(picture.pixels.astype(np.int32), -1, 0))] = True
    return np.flatnonzero(is_there)


def completed(palette: Palette) -> Palette:
    """The same palette with a table of all cells, for other pictures."""
    if palette.measured is None:
        return palette
    return replace(palette, table=compile_samples(palette.measured, palette.sampling))


def judged_again(trial: Trial, pictures: Sequence[Picture], palette: Palette) -> Palette:
    """What is read in other pictures with a palette."""
    trial.use(palette.table)
    judged = tuple(trial.judge(picture) for picture in pictures)
    return replace(palette, score=sum(one.score for one in judged), judged=judged)


def read_with(trial: Trial, pictures: Sequence[Picture], palette: Palette) -> Palette:
    """The same palette with what is read in pictures, robots that only their shape shows among it."""
    trial.use(palette.table)
    return replace(palette, judged=tuple(trial.read(picture) for picture in pictures))


def palette_of_settings(trial: Trial, table: ColorTable) -> Palette:
    """The palette of the settings, whose color table has more classes, or other places for them."""
    places = np.zeros(len(table.names), dtype=np.uint8)
    rows = [0, *(table.index(name) for name in trial.paints)]
    places[rows] = np.arange(len(rows))
    means, spreads = table.references.means[rows], table.references.spreads[rows]
    own = replace(
        table,
        names=("", *trial.paints),
        classes=places[table.classes],
        mean_bgr=table.mean_bgr[rows],
        disputed=(),
        references=table.references._replace(means=means, spreads=spreads),
    )
    return Palette(own, None, trial.settings.colors.sampling, np.zeros(len(trial.paints), dtype=np.int64))


def table_of_settings(palette: Palette, table: ColorTable) -> ColorTable:
    """A palette as a table with the classes of the settings' table; classes that are no paints claim nothing."""
    if palette.measured is None:
        return table
    rows = np.array([table.names.index(name) for name in palette.table.names])
    means, spreads = table.references.means.copy(), table.references.spreads.copy()
    means[rows], spreads[rows] = palette.table.references.means, palette.table.references.spreads
    return replace(
        table,
        classes=rows.astype(np.uint8)[palette.table.classes],
        references=table.references._replace(means=means, spreads=spreads),
    )
