"""How well the ids and headings of patterns can be told apart: what ``pslv patterns check`` prints.

``load_pattern`` refuses what cannot be told apart at all; here are the figures of what can.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Floats
from vision_core.patterns.geometry import Shape, depth_mm, middle_mm, rim_mm, turned_mm, turns_onto_itself, width_mm
from vision_core.patterns.loader import Pattern, looks
from vision_core.types.objects import Team

MIN_PX = 5.0
"""A blob narrower than this has no color of its own: its rim is mixed with what lies round it."""
TURN_STEP_DEG = 3


@dataclass(frozen=True, slots=True)
class Rival:
    """Two robots that look most alike, one of them turned."""

    one: str
    other: str
    turn_deg: float
    off_mm: float
    """How far the patch that fits worst is off its place, every color being right."""


@dataclass(frozen=True, slots=True)
class PatternReport:
    """The figures of a pattern."""

    name: str
    ids: int
    turns: int
    """In how many ways its patches lie on themselves when turned; colors alone tell these headings apart."""
    fewest_differences: int | None
    """Patches whose color differs between two ids of a team, at least, in whatever way they lie; None: one id."""
    rival: Rival | None
    """None: colors alone tell everything apart."""
    smallest_mm: float
    """Width of the smallest patch."""
    colors: tuple[str, ...]

    @property
    def coarsest_mm_per_px(self) -> float:
        """At a coarser resolution the smallest patch is narrower than MIN_PX."""
        return self.smallest_mm / MIN_PX


def report_on(pattern: Pattern) -> PatternReport:
    """The figures of a pattern."""
    turns = turns_onto_itself(pattern.patches)
    colors = dict.fromkeys(color for _, _, worn in looks(pattern) for color in worn)
    return PatternReport(
        name=pattern.name,
        ids=len(pattern.code.ids),
        turns=len(turns),
        fewest_differences=_fewest_differences(pattern, [places for _, places in turns]),
        rival=nearest_rival(pattern, pattern),
        smallest_mm=min(width_mm(patch) for patch in pattern.patches),
        colors=tuple(colors),
    )


def nearest_rival(pattern: Pattern, other: Pattern) -> Rival | None:
    """The robots of two patterns (or of one) that look most alike; None where no color has a partner.

    Both are laid with their middles on each other and turned in steps of three degrees.
    """
    turns = np.arange(0, 360, TURN_STEP_DEG)
    misfits = _misfits(pattern.patches, other.patches, np.radians(turns))
    best: Rival | None = None
    for (team, number, worn), (other_team, other_number, others) in _pairs(pattern, other):
        alike = np.array([[color == there for there in others] for color in worn])
        fits = np.where(alike, misfits, math.inf)
        off = np.maximum(fits.min(axis=2).max(axis=1), fits.min(axis=1).max(axis=1))
        if pattern is other and worn == others:
            off = _away_from_itself(off)
        nearest = int(np.argmin(off))
        if math.isfinite(off[nearest]) and (best is None or off[nearest] < best.off_mm):
            names = f"{pattern.name} {team} {number}", f"{other.name} {other_team} {other_number}"
            best = Rival(*names, float(turns[nearest]), float(off[nearest]))
    return best


def _away_from_itself(off: Floats) -> Floats:
    """A marker that is hardly turned looks like itself: only where it comes nearer to itself again does it count."""
    comes_nearer = (off <= np.roll(off, 1)) & (off <= np.roll(off, -1))
    comes_nearer[0] = False
    return np.where(comes_nearer, off, math.inf)


Look = tuple[Team, int, tuple[str, ...]]


def _pairs(pattern: Pattern, other: Pattern) -> Iterator[tuple[Look, Look]]:
    others = list(looks(other))
    return ((one, another) for one in looks(pattern) for another in others)


def _misfits(shapes: tuple[Shape, ...], others: tuple[Shape, ...], turns: Floats) -> Floats:
    """How far each patch, turned, is off each other one, at most; shape (turns, n, m) [mm]."""
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
    worn = [colors for team, _, colors in looks(pattern) if team is Team.BLUE]
    fewest: int | None = None
    for i, one in enumerate(worn):
        for other in worn[:i]:
            for places in ways:
                differ = sum(one[patch] != other[place] for patch, place in enumerate(places))
                fewest = differ if fewest is None else min(fewest, differ)
    return fewest
