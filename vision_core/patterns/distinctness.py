"""How well the ids and headings of patterns can be distinguished: the report of ``pslv patterns check``.

``load_pattern`` refuses patterns that are ambiguous; this module measures the margin of those that are not.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Floats
from vision_core.patterns.geometry import (
    PatchShape,
    depth_mm,
    middle_mm,
    rim_mm,
    turned_mm,
    turns_onto,
    width_mm,
)
from vision_core.patterns.pattern import Pattern, looks
from vision_core.patterns.worn import colors_of
from vision_core.types.objects import Team

MIN_PX = 5.0
"""A blob narrower than this has no pixel of its pure color: its edge is mixed with its surroundings."""
TURN_STEP_DEG = 3


@dataclass(frozen=True, slots=True)
class Rival:
    """Two robots that look most alike, one of them turned."""

    one: str
    other: str
    turn_deg: float
    off_mm: float
    """Distance by which the worst fitting patch is off its place, when all colors are equal."""


@dataclass(frozen=True, slots=True)
class PatternReport:
    """The figures of a pattern."""

    name: str
    ids: int
    turns: int
    """Number of turns that lay the patches on themselves; colors alone distinguish these headings."""
    fewest_differences: int | None
    """Least number of patches that differ in color or shape between two ids of a team, over all turns; None: one id."""
    rival: Rival | None
    """None: no two robots have the same colors in any turn."""
    smallest_mm: float
    """Width of the smallest patch."""
    colors: tuple[str, ...]

    @property
    def coarsest_mm_per_px(self) -> float:
        """Coarsest resolution at which the smallest patch is MIN_PX wide."""
        return self.smallest_mm / MIN_PX


def report_on(pattern: Pattern) -> PatternReport:
    """The figures of a pattern."""
    turns = turns_onto(pattern.patches, pattern.patches)
    return PatternReport(
        name=pattern.name,
        ids=len(pattern.code.ids),
        turns=len(turns),
        fewest_differences=_fewest_differences(pattern, [places for _, places in turns]),
        rival=nearest_rival(pattern, pattern),
        smallest_mm=min(width_mm(patch) for layout in pattern.layouts for patch in layout),
        colors=colors_of(dict.fromkeys(Team, (pattern,))),
    )


def nearest_rival(pattern: Pattern, other: Pattern) -> Rival | None:
    """The robots of two patterns (or of one) that look most alike; None when no two have the same colors.

    The centers of both are laid on each other, and one is turned in steps of three degrees.
    """
    turns = np.arange(0, 360, TURN_STEP_DEG)
    misfits = {
        (layout, another): _misfits(layout, another, np.radians(turns))
        for layout in pattern.layouts
        for another in other.layouts
    }
    best: Rival | None = None
    for (team, number, worn), (other_team, other_number, others) in _pairs(pattern, other):
        alike = np.array([[color == there for there in others] for color in worn])
        layout, other_layout = pattern.layout(number), other.layout(other_number)
        fits = np.where(alike, misfits[layout, other_layout], math.inf)
        off = np.maximum(fits.min(axis=2).max(axis=1), fits.min(axis=1).max(axis=1))
        if pattern is other and (worn, layout) == (others, other_layout):
            off = _local_minima(off)
        nearest = int(np.argmin(off))
        if math.isfinite(off[nearest]) and (best is None or off[nearest] < best.off_mm):
            names = f"{pattern.name} {team} {number}", f"{other.name} {other_team} {other_number}"
            best = Rival(*names, float(turns[nearest]), float(off[nearest]))
    return best


def _local_minima(off: Floats) -> Floats:
    """Distances at their local minima, inf elsewhere.

    off: distance of a marker from itself turned by a growing angle. At small angles every marker resembles itself;
    only a further minimum is a heading for which it can be mistaken. The first angle never counts.
    """
    is_minimum = (off <= np.roll(off, 1)) & (off <= np.roll(off, -1))
    is_minimum[0] = False
    return np.where(is_minimum, off, math.inf)


Look = tuple[Team, int, tuple[str, ...]]


def _pairs(pattern: Pattern, other: Pattern) -> Iterator[tuple[Look, Look]]:
    others = list(looks(other))
    return ((one, another) for one in looks(pattern) for another in others)


def _misfits(shapes: tuple[PatchShape, ...], others: tuple[PatchShape, ...], turns: Floats) -> Floats:
    """Largest distance between the edges of each turned patch and each other patch; shape (turns, n, m) [mm]."""
    middle, other_middle = np.array(middle_mm(shapes)), np.array(middle_mm(others))
    rims, other_rims = [rim_mm(shape) for shape in shapes], [rim_mm(shape) for shape in others]
    misfits = np.empty((len(turns), len(shapes), len(others)))
    for t, turn in enumerate(turns.tolist()):
        there = [turned_mm(rim, turn, middle) + (other_middle - middle) for rim in rims]
        back = [turned_mm(rim, -turn, other_middle) + (middle - other_middle) for rim in other_rims]
        for i, shape in enumerate(shapes):
            for j, other in enumerate(others):
                away = np.abs(depth_mm(other, there[i])).max(), np.abs(depth_mm(shape, back[j])).max()
                misfits[t, i, j] = max(away)
    return misfits


def _fewest_differences(pattern: Pattern, ways: list[list[int]]) -> int | None:
    """The smallest Hamming distance between ids of one team, over all ways in which the patches lie on themselves."""
    worn = [
        tuple(zip(colors, pattern.shapes_worn(number), strict=True))
        for team, number, colors in looks(pattern)
        if team is Team.BLUE
    ]
    fewest: int | None = None
    for i, one in enumerate(worn):
        for other in worn[:i]:
            for places in ways:
                differ = sum(one[patch] != other[place] for patch, place in enumerate(places))
                fewest = differ if fewest is None else min(fewest, differ)
    return fewest
