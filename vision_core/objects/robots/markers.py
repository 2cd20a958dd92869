"""A team's marker as the hot path needs it, derived once from its pattern file."""

import math
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.errors import SettingsError
from vision_core.geometry import Floats, Mask, frozen
from vision_core.native.kernels import Boxed, box, kernel
from vision_core.objects.robots.body_points import body_points_of
from vision_core.objects.robots.code_shapes import CodeShapes, code_shapes
from vision_core.objects.robots.held import NO_ROW
from vision_core.objects.robots.shapes import (
    HEADING_STEPS,
    MIN_STEPS_APART,
    PatchShape,
    heading_score,
    measured_from,
    shape_from,
)
from vision_core.patterns.geometry import area_mm2, centroid_mm, depth_mm, inner_points_mm
from vision_core.patterns.pattern import CODE, TEAM, Patch, Pattern
from vision_core.settings.schema import TeamRobotSettings
from vision_core.types.colors import ColorTable, References
from vision_core.types.objects import Team
from vision_core.types.tables import TEAMS

Integers = NDArray[np.int64]
Points = NDArray[np.complex128]

ANCHOR_ROLE, SLOT_ROLE = 1, 2
"""What a blob of a color class may be in a marker; bits."""

NO_DIGIT = -1
"""The digit of a color class that a slot cannot have."""

POINTS, INNER_DEPTH = 16, 0.45
"""Points at which a patch is measured; how deep they lie in it, as a share of its depth."""

MIN_RIVAL_SCORE = 0.5
"""A heading is ruled out when the team patch's shape scores less with it."""
MAX_ALTERNATIVE_SCORE = 0.7
"""The team patch's shape shows the heading by itself when all other headings score less."""


class MarkerDetails(NamedTuple):
    """What only some markers need, boxed: every array in a Marker costs time wherever one is handed on."""

    shape_values: Integers
    """Factor of each slot's shape in the code, 0 where all robots have the same shape; shape (s,)."""
    shapes_worn: Integers
    """Which of its shapes every slot of every robot has, or NO_SHAPE; shape (n, s)."""
    code_shapes: CodeShapes
    body_points_m: Floats
    """Points all over the robot's top but not near the edges of patches, shape (p, 2)."""
    body_patches: Integers
    """In which patch each lies, 0 in the anchor, 1 in the first slot, or GROUND; shape (p,)."""
    body_m2: float
    """Area of the robot's top."""
    team_colors: Mask
    """Which classes patches of the team may have, by any of its markers; shape (classes,)."""


class Marker(NamedTuple):
    """A pattern in robot space (x forward, y left) [m]: the team's patch is the anchor, the other patches are slots."""

    number: int
    """Among the markers of both teams."""
    team: int
    """Number of the team."""
    height_m: float
    radius_m: float
    color_roles: NDArray[np.uint8]
    """What blobs of each color class may be, ANCHOR_ROLE | SLOT_ROLE; shape (classes,)."""
    anchor_class: int
    anchor_m: Floats
    """Shape (2,)."""
    anchor_area_m2: float
    shape: PatchShape
    """Of the anchor."""
    has_direction: bool
    """Whether the anchor's shape shows anything of the heading."""
    slots_m: Floats
    """Shape (s, 2)."""
    slot_offsets_m: Floats
    """The slots' places relative to the anchor, shape (s, 2)."""
    areas_m2: Floats
    """Of the slots' patches, the smallest and the largest of the shapes that each may have; shape (s, 2)."""
    min_area_m2: float
    """Of the smallest patch."""
    reach_m: Floats
    """Distance from the anchor to the nearest and to the farthest slot, shape (2,)."""
    area_fractions: Floats
    """Of the marker's painted area: the anchor's, then every slot's; shape (1 + s,)."""
    radii_m: Floats
    """Of patches that are circles, 0 for others: the anchor's, then every slot's; shape (1 + s,)."""
    digits: Integers
    """Digit of each color class at each slot, or NO_DIGIT; shape (s, classes)."""
    place_values: Integers
    """Factor of each slot's digit in the code, 0 where all robots have the same color; shape (s,)."""
    is_verifiable: bool
    """Whether all patches are circles, which together determine the heading (``verification``)."""
    has_code: bool
    """Whether robots differ in their colors or shapes."""
    has_shapes: bool
    """Whether they differ in shapes."""
    codes: Integers
    """The codes of the pattern's robots, shape (n,)."""
    ids: Integers
    """The robots' ids, shape (n,)."""
    worn: Integers
    """Color class of every patch of every robot, the anchor first; shape (n, 1 + s)."""
    patch_points_m: Floats
    """Points well inside of each patch, in the robot; shape (1 + s, POINTS, 2)."""
    details: Boxed
    """MarkerDetails."""
    references: References
    """What the classes look like."""
    min_slots_for_heading: int
    """So many slots, whichever they are, determine the heading; one more than the pattern has when it is symmetric."""
    min_slots_with_shape: int
    """The same where the anchor's shape is measured; 0 when the shape determines the heading by itself."""


def marker_of(
    pattern: Pattern, robots: TeamRobotSettings, team: Team, number: int, table: ColorTable, tolerance_m: float,
    team_colors: Mask | None = None,
) -> Marker:  # fmt: skip
    """Derive a marker of a team. Raises SettingsError when the pattern has colors without a class.

    number: of the marker among those of both teams; tolerance_m: how far from its place a patch may be;
    team_colors: classes that patches of the team may have, None for those of this marker.
    """
    _check_colors(pattern, team, table)
    ranges = np.array([_area_range_mm2(patch) for patch in pattern.patches]) / 1e6
    areas = np.sqrt(ranges[:, 0] * ranges[:, 1])
    centers = np.array([centroid_mm(patch) for patch in pattern.patches]) / 1000.0
    anchor = next(index for index, patch in enumerate(pattern.patches) if patch.color == TEAM)
    others = [index for index in range(len(pattern.patches)) if index != anchor]
    slots = centers[others].reshape(-1, 2)
    digits, place_values, shape_values = _digits(pattern, others, table)
    reach = np.hypot(*(slots - centers[anchor]).T) if len(slots) else np.zeros(1)
    shape = shape_from(inner_points_mm(pattern.patches[anchor]) / 1000.0)
    color_roles = np.zeros(len(table.names), dtype=np.uint8)
    color_roles[(digits != NO_DIGIT).any(axis=0)] |= SLOT_ROLE
    color_roles[table.index(pattern.team_color(team))] |= ANCHOR_ROLE
    body_points, body_patches = body_points_of(pattern, [anchor, *others])
    codes = [_code_number(pattern, number) for number in pattern.code_by_id]
    min_slots, min_slots_with_shape = _min_slots(slots - centers[anchor], digits, tolerance_m, shape)
    details = MarkerDetails(
        shape_values=frozen(shape_values),
        shapes_worn=frozen(_shapes_worn(pattern, others)),
        code_shapes=code_shapes(pattern, others),
        body_points_m=frozen(body_points),
        body_patches=frozen(body_patches),
        body_m2=float((math.pi if pattern.robot.outline == "circle" else 4.0) * robots.radius_m**2),
        team_colors=frozen(color_roles > 0 if team_colors is None else team_colors),
    )
    radii = np.array([_radius_m(pattern.patches[index]) for index in (anchor, *others)])
    return Marker(
        number=number,
        team=TEAMS.index(team),
        height_m=robots.height_m,
        radius_m=robots.radius_m,
        color_roles=frozen(color_roles),
        anchor_class=table.index(pattern.team_color(team)),
        anchor_m=frozen(centers[anchor].copy()),
        anchor_area_m2=float(areas[anchor]),
        shape=shape,
        has_direction=bool(shape.weights.any()),
        slots_m=frozen(slots.copy()),
        slot_offsets_m=frozen(slots - centers[anchor]),
        areas_m2=frozen(ranges[others].reshape(-1, 2)),
        min_area_m2=float(ranges.min()),
        reach_m=frozen(np.array([reach.min(), reach.max()])),
        area_fractions=frozen(areas[[anchor, *others]] / areas.sum()),
        radii_m=frozen(radii),
        digits=frozen(digits),
        place_values=frozen(place_values),
        is_verifiable=bool((radii > 0.0).all()) and min_slots <= len(slots),
        has_code=pattern.digits > 0,
        has_shapes=bool(shape_values.any()),
        codes=frozen(np.array(codes, dtype=np.int64)),
        ids=frozen(np.array(list(pattern.code_by_id), dtype=np.int64)),
        worn=frozen(_worn(pattern, [anchor, *others], team, table)),
        patch_points_m=frozen(np.array([_inner_points_m(pattern.patches[index]) for index in (anchor, *others)])),
        details=box(details),
        references=table.references,
        min_slots_for_heading=min_slots,
        min_slots_with_shape=min_slots_with_shape,
    )


@kernel
def marker_with(markers: tuple[Marker, ...], team: int, number: int) -> int:
    """The marker that a team's robot with an id wears."""
    for one in range(len(markers)):
        if markers[one].team == team and row_of_id(markers[one], number) != NO_ROW:
            return one
    return 0


@kernel
def row_of_id(marker: Marker, number: int) -> int:
    """The row of an id in a marker's tables, NO_ROW where no robot has it."""
    for row in range(len(marker.ids)):
        if marker.ids[row] == number:
            return row
    return NO_ROW


def tells_heading(marker: Marker) -> bool:
    """Do all patches together, or the anchor's shape, determine the heading at the tolerance that the marker has?"""
    return min(marker.min_slots_for_heading, marker.min_slots_with_shape) <= len(marker.slots_m)


def largest_tolerance_m(marker: Marker, below_m: float) -> float:
    """The largest distance of a patch from its place, below another one, at which the patches determine the heading.

    In whole millimetres; 0 when there is none.
    """
    for tolerance_mm in range(math.ceil(1e3 * below_m) - 1, 0, -1):
        counts = _min_slots(marker.slot_offsets_m, marker.digits, tolerance_mm / 1e3, marker.shape)
        if min(counts) <= len(marker.slots_m):
            return tolerance_mm / 1e3
    return 0.0


def _check_colors(pattern: Pattern, team: Team, table: ColorTable) -> None:
    needed = {patch.color for patch in pattern.patches} - {TEAM, CODE}
    if pattern.digits:
        needed |= set(pattern.code.colors)
    if unknown := sorted((needed | {pattern.team_color(team)}) - set(table.names)):
        raise SettingsError(
            f"pattern {pattern.name}: colors",
            found=", ".join(unknown),
            accepted=f"color classes: {', '.join(table.names[1:])}; pslv colors sample measures further ones",
        )


def _radius_m(patch: Patch) -> float:
    is_disc = patch.circle_mm is not None and not patch.hidden_by and not patch.shapes
    return patch.circle_mm[2] / 2000.0 if is_disc and patch.circle_mm else 0.0


def _area_range_mm2(patch: Patch) -> tuple[float, float]:
    areas = [area_mm2(one) for one in patch.shapes or (patch,)]
    return min(areas), max(areas)


def _shapes_worn(pattern: Pattern, slots: Sequence[int]) -> Integers:
    worn = [pattern.shapes_worn(number) for number in pattern.code_by_id]
    return np.array([[shapes[index] for index in slots] for shapes in worn], dtype=np.int64).reshape(len(worn), -1)


def _worn(pattern: Pattern, order: Sequence[int], team: Team, table: ColorTable) -> Integers:
    """The class of each patch, in an order of the patches, for every id."""
    worn = [pattern.colors_worn(team, number) for number in pattern.code_by_id]
    return np.array([[table.index(colors[index]) for index in order] for colors in worn], dtype=np.int64)


def _inner_points_m(patch: Patch) -> Floats:
    """POINTS of a patch that are at least INNER_DEPTH of its depth inside, spread evenly over it; shape (POINTS, 2)."""
    points = inner_points_mm(patch)
    depth = depth_mm(patch, points)
    inner = points[depth >= INNER_DEPTH * depth.max()]
    chosen = np.random.default_rng(1).choice(len(inner), POINTS, replace=len(inner) < POINTS)
    points_m: Floats = inner[chosen] / 1000.0
    return points_m


def _digits(
    pattern: Pattern, slots: Sequence[int], table: ColorTable
) -> tuple[Integers, Integers, Integers]:  # fmt: skip
    """Digit of each color class at each slot, and the place values of each slot's color and shape in the code."""
    digits = np.full((len(slots), len(table.names)), NO_DIGIT, dtype=np.int64)
    place_values, shape_values = np.zeros(len(slots), dtype=np.int64), np.zeros(len(slots), dtype=np.int64)
    value = 1
    for row, index in enumerate(slots):
        color = pattern.patches[index].color
        if color == CODE:
            place_values[row], value = value, value * len(pattern.code.colors)
            for digit, name in enumerate(pattern.code.colors):
                digits[row, table.index(name)] = digit
        else:
            digits[row, table.index(color)] = 0
        if pattern.patches[index].shapes:
            shape_values[row], value = value, value * len(pattern.code.shapes)
    return digits, place_values, shape_values


def _code_number(pattern: Pattern, marker_id: int) -> int:
    """The code of an id as a number; its first letter is the least significant digit."""
    number, value = 0, 1
    for letter, alphabet in zip(pattern.code_by_id[marker_id], pattern.alphabets, strict=True):
        number, value = number + value * alphabet.index(letter), value * len(alphabet)
    return number


def _min_slots(offsets_m: Floats, digits: Integers, tolerance_m: float, shape: PatchShape) -> tuple[int, int]:
    """How many slots determine the heading, without and with the anchor's shape: no turn maps them to other slots."""
    offsets: Points = offsets_m[:, 0] + 1j * offsets_m[:, 1]
    share_color = ((digits != NO_DIGIT)[:, None] & (digits != NO_DIGIT)[None]).any(axis=2)
    without_shape = with_shape = 1
    for number in range(1, len(offsets) + 1):
        turns = [
            turn
            for chosen in combinations(range(len(offsets)), number)
            for turn in _confusing_turns(offsets, chosen, share_color, tolerance_m)
        ]
        if turns:
            without_shape = number + 1
        if any(_score_of_turn(shape, turn) >= MIN_RIVAL_SCORE for turn in turns):
            with_shape = number + 1
    steps = range(MIN_STEPS_APART, HEADING_STEPS - MIN_STEPS_APART + 1)
    turns = [2.0 * math.pi * step / HEADING_STEPS for step in steps]
    if all(_score_of_turn(shape, turn) < MAX_ALTERNATIVE_SCORE for turn in turns):
        with_shape = 0
    return without_shape, with_shape


def _confusing_turns(
    offsets: Points, chosen: tuple[int, ...], share_color: Mask, tolerance_m: float
) -> Iterator[float]:
    """The turns about the anchor that bring the chosen slots to the places of others [rad]."""
    pending: list[tuple[int, ...]] = [()]
    while pending:
        image = pending.pop()
        if len(image) == len(chosen):
            turn = float(np.angle((offsets[list(chosen)].conj() * offsets[list(image)]).sum()))
            off = np.abs(offsets[list(chosen)] * np.exp(1j * turn) - offsets[list(image)])
            if image != chosen and (off <= tolerance_m).all():
                yield turn
            continue
        here = chosen[len(image)]
        for other in range(len(offsets)):
            differences = [
                abs(abs(offsets[here] - offsets[a]) - abs(offsets[other] - offsets[b]))
                for a, b in zip(chosen, image, strict=False)
            ]
            as_far = abs(abs(offsets[here]) - abs(offsets[other])) <= tolerance_m
            alike = max(differences, default=0.0) <= 2.0 * tolerance_m
            if other not in image and share_color[here, other] and as_far and alike:
                pending.append((*image, other))


def _score_of_turn(shape: PatchShape, turn_rad: float) -> float:
    """How well the drawn shape agrees with itself, turned, 0..1."""
    return heading_score(shape, measured_from(shape)[0], turn_rad)
