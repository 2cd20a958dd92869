"""A team's marker as the hot path needs it, derived once from its pattern file."""

import math
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.errors import SettingsError
from vision_core.geometry import Floats, frozen
from vision_core.objects.robots.shapes import (
    APART,
    COARSE,
    FIRST_MOMENT,
    LONG,
    SHAPE_LENGTH,
    WIDE,
    Shape,
    agreement,
    shape_from,
)
from vision_core.patterns.geometry import area_mm2, centroid_mm, inner_points_mm
from vision_core.patterns.loader import CODE, TEAM, Patch, Pattern
from vision_core.settings.schema import TeamRobotSettings
from vision_core.types.colors import ColorTable
from vision_core.types.objects import Team

Numbers = NDArray[np.int64]
Points = NDArray[np.complex128]

ANCHOR, SLOT = 1, 2
"""What blobs of a color class may be: bits."""

REFUSED = -1
"""A color class that a slot does not wear."""

RIVAL_AGREEMENT = 0.5
"""A heading with which the team patch's shape agrees less is out of the question."""
ALONE_AGREEMENT = 0.7
"""A team patch whose shape agrees less with every other heading tells it alone."""


class Marker(NamedTuple):
    """A pattern in robot space (x forward, y left) [m]; the team's patch is the anchor, the others are slots."""

    team: int
    """Number of the team."""
    height_m: float
    radius_m: float
    wears: NDArray[np.uint8]
    """What blobs of each color class may be, shape (classes,)."""
    anchor_class: int
    anchor_m: Floats
    """Shape (2,)."""
    anchor_area_m2: float
    shape: Shape
    """Of the anchor."""
    pointed: bool
    """Whether the anchor's shape tells anything of the heading."""
    slots_m: Floats
    """Shape (s, 2)."""
    arms_m: Floats
    """The same, seen from the anchor."""
    areas_m2: Floats
    """Shape (s,)."""
    least_area_m2: float
    """Of all patches."""
    reach_m: Floats
    """From the anchor to the nearest and to the farthest slot, shape (2,)."""
    shares: Floats
    """Of the marker's painted area: the anchor's, then every slot's; shape (1 + s,)."""
    radii_m: Floats
    """Of the patches that are circles, 0 for others: the anchor's, then every slot's; shape (1 + s,)."""
    digits: Numbers
    """Value of each color class at each slot, or REFUSED; shape (s, classes)."""
    places: Numbers
    """What a digit at each slot counts in the code, 0 where all robots wear the same; shape (s,)."""
    coded: bool
    """Whether there is a code to read."""
    codes: Numbers
    """The codes that are worn, shape (n,)."""
    ids: Numbers
    """By whom, shape (n,)."""
    enough: int
    """As many slots tell the heading, whichever they are; one more than there are when the pattern repeats."""
    enough_shaped: int
    """As many, where the anchor's shape is seen; 0 when it tells the heading alone."""


def marker_of(
    pattern: Pattern, robots: TeamRobotSettings, team: Team, number: int, table: ColorTable, tolerance_m: float
) -> Marker:
    """Derive a team's marker. Raises SettingsError when it wears colors without a class.

    number: of the team in tables; tolerance_m: how far from its place a patch may be.
    """
    _check_colors(pattern, team, table)
    areas = np.array([area_mm2(patch) for patch in pattern.patches]) / 1e6
    centers = np.array([centroid_mm(patch) for patch in pattern.patches]) / 1000.0
    anchor = next(index for index, patch in enumerate(pattern.patches) if patch.color == TEAM)
    others = [index for index in range(len(pattern.patches)) if index != anchor]
    slots = centers[others].reshape(-1, 2)
    digits, places = _digits(pattern, others, table)
    reach = np.hypot(*(slots - centers[anchor]).T) if len(slots) else np.zeros(1)
    shape = shape_from(inner_points_mm(pattern.patches[anchor]) / 1000.0)
    wears = np.zeros(len(table.names), dtype=np.uint8)
    wears[(digits != REFUSED).any(axis=0)] |= SLOT
    wears[table.index(team)] |= ANCHOR
    codes = [_number(code, pattern) for code in pattern.code_by_id.values()]
    enough, shaped = _enough(slots - centers[anchor], digits, tolerance_m, shape)
    return Marker(
        team=number,
        height_m=robots.height_m,
        radius_m=robots.radius_m,
        wears=frozen(wears),
        anchor_class=table.index(team),
        anchor_m=frozen(centers[anchor].copy()),
        anchor_area_m2=float(areas[anchor]),
        shape=shape,
        pointed=bool(shape.weights.any()),
        slots_m=frozen(slots.copy()),
        arms_m=frozen(slots - centers[anchor]),
        areas_m2=frozen(areas[others]),
        least_area_m2=float(areas.min()),
        reach_m=frozen(np.array([reach.min(), reach.max()])),
        shares=frozen(areas[[anchor, *others]] / areas.sum()),
        radii_m=frozen(np.array([_radius_m(pattern.patches[index]) for index in (anchor, *others)])),
        digits=frozen(digits),
        places=frozen(places),
        coded=pattern.digits > 0,
        codes=frozen(np.array(codes, dtype=np.int64)),
        ids=frozen(np.array(list(pattern.code_by_id), dtype=np.int64)),
        enough=enough,
        enough_shaped=shaped,
    )


def _check_colors(pattern: Pattern, team: Team, table: ColorTable) -> None:
    worn = {patch.color for patch in pattern.patches} - {TEAM, CODE}
    if pattern.digits:
        worn |= set(pattern.code.colors)
    if unknown := sorted((worn | {team}) - set(table.names)):
        raise SettingsError(
            f"pattern {pattern.name}: colors",
            found=", ".join(unknown),
            accepted=f"color classes: {', '.join(table.names[1:])}; pslv colors sample measures further ones",
        )


def _radius_m(patch: Patch) -> float:
    return patch.circle_mm[2] / 2000.0 if patch.circle_mm is not None else 0.0


def _digits(pattern: Pattern, slots: Sequence[int], table: ColorTable) -> tuple[Numbers, Numbers]:
    digits = np.full((len(slots), len(table.names)), REFUSED, dtype=np.int64)
    places = np.zeros(len(slots), dtype=np.int64)
    place = 1
    for row, index in enumerate(slots):
        color = pattern.patches[index].color
        if color == CODE:
            places[row], place = place, place * len(pattern.code.colors)
            for digit, name in enumerate(pattern.code.colors):
                digits[row, table.index(name)] = digit
        else:
            digits[row, table.index(color)] = 0
    return digits, places


def _number(code: str, pattern: Pattern) -> int:
    """A code as the number that its digits make, the first one counting least."""
    initials = [color[0].upper() for color in pattern.code.colors]
    return sum(initials.index(letter) * len(initials) ** place for place, letter in enumerate(code))


def _enough(slots_m: Floats, digits: Numbers, tolerance_m: float, shape: Shape) -> tuple[int, int]:
    """How many slots tell the heading, without and with the anchor's shape: no other slots could be taken for them.

    slots_m: seen from the anchor.
    """
    slots: Points = slots_m[:, 0] + 1j * slots_m[:, 1]
    shared = ((digits != REFUSED)[:, None] & (digits != REFUSED)[None]).any(axis=2)
    enough = shaped = 1
    for chosen in range(1, len(slots) + 1):
        turns = [
            turn
            for those in combinations(range(len(slots)), chosen)
            for turn in _confusions(slots, those, shared, tolerance_m)
        ]
        if turns:
            enough = chosen + 1
        if any(_agrees(shape, turn) >= RIVAL_AGREEMENT for turn in turns):
            shaped = chosen + 1
    steps = range(APART, COARSE - APART + 1)
    alone = all(_agrees(shape, 2.0 * math.pi * step / COARSE) < ALONE_AGREEMENT for step in steps)
    return enough, 0 if alone else shaped


def _confusions(
    slots: Points, those: tuple[int, ...], shared: NDArray[np.bool_], tolerance_m: float
) -> Iterator[float]:
    """The turns about the anchor that bring some slots to where others are."""
    pending: list[tuple[int, ...]] = [()]
    while pending:
        image = pending.pop()
        if len(image) == len(those):
            turn = float(np.angle((slots[list(those)].conj() * slots[list(image)]).sum()))
            off = np.abs(slots[list(those)] * np.exp(1j * turn) - slots[list(image)])
            if image != those and (off <= tolerance_m).all():
                yield turn
            continue
        here = those[len(image)]
        for other in range(len(slots)):
            apart = [
                abs(abs(slots[here] - slots[a]) - abs(slots[other] - slots[b]))
                for a, b in zip(those, image, strict=False)
            ]
            near = abs(abs(slots[here]) - abs(slots[other])) <= tolerance_m
            if other not in image and shared[here, other] and near and max(apart, default=0.0) <= 2.0 * tolerance_m:
                pending.append((*image, other))


def _agrees(shape: Shape, turn_rad: float) -> float:
    """How well the drawn shape agrees with itself, turned."""
    seen = np.zeros(SHAPE_LENGTH)
    seen[LONG], seen[WIDE] = shape.spread_m2
    seen[FIRST_MOMENT:] = shape.moments.ravel()
    return agreement(shape, seen, turn_rad)
