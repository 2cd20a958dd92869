"""Which paint is which: names for the colors of things that have the shape of markers and balls.

Colors are compared by their chromaticity (``objects.robots.references``). Under another light all of them are shifted
alike, and a camera that makes colors paler draws all of them towards grey alike; beyond that, every manufacturer's pink
is another one. So the paint k is expected at ``scale * typical[k] + shift``, give or take PAINT_SD, and the patches of
one paint lie round its place as print and light spread them (PATCH_SD). For many scales and shifts the likeliest
reading of every candidate is taken, the paints' places follow from the readings, and so on until nothing changes
(expectation maximization with hard decisions). The start under which everything together is likeliest wins.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats
from vision_core.objects.robots.shape_search import Candidate
from vision_core.palette.trial import Kind
from vision_core.types.colors import chromaticity

SCALES = (0.35, 0.55, 0.8, 1.2)
SHIFTS = (-0.4, -0.2, 0.0, 0.2, 0.4)
SHIFT_SD = 0.2
USUAL_SCALE, SCALE_SD = 0.8, 0.4
MARGIN_WEIGHT = 2.0
"""A reading counts at most this many times its margin: where all paints look alike, everything is a marker."""
LEARN_MARGIN = 1.0
"""Readings of a smaller margin teach nothing."""
PAINT_SD, PATCH_SD = 0.3, 0.12
UNKNOWN_LOG_DENSITY = math.log(0.1)
"""Of a color that is no paint: the chromaticities that cameras show fill about ten units."""
PLAIN_SD, PLAIN_SHARE = 0.15, 0.5
"""Deviation of the floor's chromaticities, and how much of what is no paint is floor."""
ROUNDS = 8
COLORLESS = 0.15
"""Typical paints with a smaller chromaticity are white or grey."""
COLORLESS_RADIUS, COLORED = 0.35, -10.0
"""A white patch is as likely a floor's as a paint's; a patch farther than this from grey is not white: log odds."""
MIN_EVIDENCE, PATCH_EVIDENCE = 4.0, 2.0
"""Log odds from which on a candidate is taken for what its colors say; of each of its patches, where it has few."""


class Group(NamedTuple):
    """Candidates of one shape, in the pictures together, and what they may be."""

    candidates: Sequence[Candidate]
    kinds: Sequence[Kind]


@dataclass(frozen=True, slots=True)
class Reading:
    """What a candidate is taken for."""

    group: int
    row: int
    """Of the candidate's pose, in the group's stack."""
    kind: str
    id: int
    evidence: float
    """Log odds of this reading against something that is no marker."""
    margin: float
    """By how much the next likely reading falls behind."""
    paints: tuple[int, ...]
    only_id: bool
    """Has its kind one id only?"""

    @property
    def label(self) -> tuple[int, int, str, int]:
        """What tells it from other readings."""
        return self.group, self.row, self.kind, self.id


@dataclass(frozen=True, slots=True)
class Naming:
    """Paints with their places, and what is read by them."""

    likelihood: float
    """Of everything together, a logarithm."""
    means: Floats
    """Chromaticity of every paint, shape (paints, 2)."""
    readings: tuple[Reading, ...]


class _Stack(NamedTuple):
    """All poses of a group's candidates in one array."""

    colors: Floats
    """Chromaticities, shape (poses, patches, 2)."""
    shape_odds: Floats
    clutter: Floats
    """Log density of each patch's color when it is no paint, shape (poses, patches)."""
    owner: NDArray[np.int64]
    """Candidate of each pose."""


def name_paints(groups: Sequence[Group], typical: Floats, plain: Floats) -> list[Naming]:
    """Name the colors of candidates. typical: chromaticity of every paint, (paints, 2); plain: of the floor, (n, 2)."""
    stacks = [_stack(group, plain) for group in groups]
    found = [
        _solve(groups, stacks, typical, scale, np.array([blue, red]))
        for scale in SCALES
        for blue in SHIFTS
        for red in SHIFTS
    ]
    return sorted(found, key=lambda one: -one.likelihood)


def _stack(group: Group, plain: Floats) -> _Stack:
    colors, odds, owner = [], [], []
    for index, one in enumerate(group.candidates):
        for pose in range(len(one.poses)):
            colors.append(chromaticity(one.colors[pose]))
            score = min(float(one.poses[pose, 0]), 0.99)
            odds.append(math.log(score / (1.0 - score)))
            owner.append(index)
    patches = group.kinds[0].worn.shape[1]
    stacked = np.array(colors).reshape(-1, patches, 2)
    near = ((stacked[:, :, None] - plain) ** 2).sum(axis=-1).min(axis=-1) if stacked.size else np.zeros((0, patches))
    floor = np.exp(-0.5 * near / PLAIN_SD**2) / (math.tau * PLAIN_SD**2)
    clutter = np.log((1.0 - PLAIN_SHARE) * math.exp(UNKNOWN_LOG_DENSITY) + PLAIN_SHARE * floor)
    return _Stack(stacked, np.array(odds), clutter, np.array(owner, dtype=np.int64))


def _solve(groups: Sequence[Group], stacks: Sequence[_Stack], typical: Floats, scale: float, shift: Floats) -> Naming:
    """Name the colors from one scale and shift of the typical paints on."""
    expected = scale * typical + shift
    colorless = np.hypot(*typical.T) < COLORLESS
    means, spread = expected.copy(), np.full(len(typical), PAINT_SD)
    readings: tuple[Reading, ...] = ()
    for _ in range(ROUNDS):
        before, readings = readings, _read(groups, stacks, means, spread, colorless)
        # places of the paints: their patches' mean, drawn towards where they are expected
        total, counts = np.zeros_like(means), np.zeros(len(typical), dtype=np.int64)
        for one in readings:
            if one.margin < LEARN_MARGIN:
                continue
            for paint, color in zip(one.paints, stacks[one.group].colors[one.row], strict=True):
                total[paint] += color
                counts[paint] += 1
        weight = (PATCH_SD / PAINT_SD) ** 2
        means = (weight * expected + total) / (weight + counts)[:, None]
        spread = np.sqrt(PATCH_SD**2 + PAINT_SD**2 * weight / (weight + counts))
        if [one.label for one in readings] == [one.label for one in before]:
            break
    evidence = sum(min(one.evidence, MARGIN_WEIGHT * one.margin) for one in _without_twins(readings))
    stretched = math.log(scale / USUAL_SCALE) / SCALE_SD
    away = stretched**2 + ((means - expected) ** 2).sum() / PAINT_SD**2 + (shift**2).sum() / SHIFT_SD**2
    return Naming(evidence - 0.5 * float(away), means, readings)


def _without_twins(readings: Sequence[Reading]) -> list[Reading]:
    """The readings with the surest robot of each team and id only: there are no two."""
    best: dict[tuple[str, int], Reading] = {}
    alike = [one for one in readings if one.only_id]
    for one in readings:
        key = one.kind, one.id
        if not one.only_id and (key not in best or best[key].margin < one.margin):
            best[key] = one
    return [*best.values(), *alike]


def _read(
    groups: Sequence[Group], stacks: Sequence[_Stack], means: Floats, spread: Floats, colorless: NDArray[np.bool_]
) -> tuple[Reading, ...]:
    """The likeliest reading of every candidate that is likelier a marker than not."""
    found = []
    for number, (group, stack) in enumerate(zip(groups, stacks, strict=True)):
        if not len(stack.owner):
            continue
        away = ((stack.colors[:, :, None] - means) ** 2).sum(axis=-1)
        odds = -0.5 * away / spread**2 - np.log(math.tau * spread**2) - stack.clutter[..., None]
        odds[..., colorless] = np.where(away[..., colorless] < COLORLESS_RADIUS**2, 0.0, COLORED)
        patches = np.arange(odds.shape[1])
        least = min(MIN_EVIDENCE, PATCH_EVIDENCE * len(patches))
        # per pose and reading: the sum over the patches, each with the paint that the reading says
        table = np.concatenate([odds[:, patches, kind.worn].sum(axis=-1) for kind in group.kinds], axis=1)
        table += stack.shape_odds[:, None]
        labels = [(kind, row) for kind in group.kinds for row in range(len(kind.ids))]
        for candidate in np.unique(stack.owner):
            rows = np.flatnonzero(stack.owner == candidate)
            own = table[rows]
            pose, label = divmod(int(own.argmax()), own.shape[1])
            evidence = float(own[pose, label])
            if evidence < least:
                continue
            own[pose, label] = -math.inf
            margin = evidence - float(own.max())
            kind, row = labels[label]
            paints = tuple(kind.worn[row].tolist())
            found.append(
                Reading(number, int(rows[pose]), kind.name, kind.ids[row], evidence, margin, paints, len(kind.ids) == 1)
            )
    return tuple(found)
