"""The painted lines of a field as sections: short pieces, across each of which the picture is read once."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from vision_core.calibration.lens import MEASURES, Lens
from vision_core.geometry import Floats
from vision_core.models.field import field_lines
from vision_core.settings.schema import FieldSettings

NAMES = (
    *("touch line at the bottom", "touch line at the top", "goal line at the left", "goal line at the right"),
    *("halfway line", "left penalty area, bottom", "left penalty area, front", "left penalty area, top"),
    *("right penalty area, bottom", "right penalty area, front", "right penalty area, top"),
)
"""Of ``field_lines``, in its order. Left is the goal at negative x, the top has positive y."""
TOUCH_LINES = NAMES[:2]
CIRCLE = "center circle"
OUTER_LINES, MAX_WALL_GAP_M = 4, 0.02
"""The first of NAMES lie along the walls, unless these stand farther outside."""
POINTS_PER_SECTION = 8
SECTION_PX = 10.0
"""Length of a section in the picture."""
MIN_SECTIONS, MAX_SECTIONS = 4, 60
END_GAP = 0.03
"""Share of a line at each end that is left out: other lines meet it there."""
STEP_M = 1e-4

Path: TypeAlias = Callable[[Floats], tuple[Floats, Floats]]
"""Shares of a line's length, shape (n,) -> places [m] and unit vectors across it, shape (n, 2) each."""


@dataclass(frozen=True, slots=True, eq=False)
class Painted:
    """Sections of all painted lines of a field."""

    names: tuple[str, ...]
    """Of the lines."""
    line: NDArray[np.intp]
    """Index of each section's line, shape (n,)."""
    points_m: Floats
    """Points on the middle of each section's line, shape (n, k, 2)."""
    across: Floats
    """Unit vector across the line in the field at each section's middle, shape (n, 2)."""
    moves: Floats
    """How each section moves with the field's measures (``lens.MEASURES``), shape (n, 2, 4)."""
    inward: NDArray[np.int8]
    """1 or -1 for lines along a wall: the carpet is in the direction of ``across``, or against it; 0: on both."""
    width_m: float

    def __len__(self) -> int:
        return len(self.line)

    @property
    def middles_m(self) -> Floats:
        """The sections' middles, shape (n, 2)."""
        middles: Floats = self.points_m.mean(axis=1)
        return middles


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Sections as a lens sees them."""

    points_px: Floats
    """Shape (n, k, 2)."""
    normals: Floats
    """Unit vectors across the lines in the picture, shape (n, 2); their direction is that of ``Painted.across``."""
    half_px: Floats
    """Half the lines' widths in the picture, shape (n,)."""
    inward: NDArray[np.int8]
    """As of ``Painted``, shape (n,)."""


def painted_sections(field: FieldSettings, pixels_per_metre: float) -> Painted:
    """The field's lines cut into sections of about SECTION_PX; none on a field without painted lines."""
    names, paths, lengths = _paths(field)
    numbers, points, across, moves = [], [], [], []
    measures = [(name, getattr(field, name)) for name in MEASURES]
    changed = [replace(field, **{name: value + STEP_M}) if value else None for name, value in measures]
    longer = [None if other is None else _paths(other)[1] for other in changed]
    for number, (path, length_m) in enumerate(zip(paths, lengths, strict=True)):
        count = int(np.clip(length_m * pixels_per_metre / SECTION_PX, MIN_SECTIONS, MAX_SECTIONS))
        section_m = min(SECTION_PX / pixels_per_metre, length_m / count)
        middles = END_GAP + (1.0 - 2.0 * END_GAP) * (np.arange(count) + 0.5) / count
        spread = (np.arange(POINTS_PER_SECTION) + 0.5) / POINTS_PER_SECTION - 0.5
        shares = middles[:, None] + spread * section_m / length_m
        points.append(path(shares.ravel())[0].reshape(count, POINTS_PER_SECTION, 2))
        across.append(path(middles)[1])
        moves.append(_moves(path, [None if paths is None else paths[number] for paths in longer], middles))
        numbers.append(np.full(count, number, dtype=np.intp))
    if not points:
        none, empty = np.empty(0, dtype=np.intp), np.empty((0, 2))
        sections = np.empty((0, POINTS_PER_SECTION, 2))
        return Painted((), none, sections, empty, np.empty((0, 2, len(MEASURES))), none.astype(np.int8), 0.0)
    line, places, normals = np.concatenate(numbers), np.concatenate(points), np.concatenate(across)
    is_outer = (line < OUTER_LINES) & field.walls & (field.margin_m <= MAX_WALL_GAP_M)
    inward = np.where(is_outer, -np.sign((places.mean(axis=1) * normals).sum(axis=1)), 0.0).astype(np.int8)
    return Painted(tuple(names), line, places, normals, np.concatenate(moves), inward, field.line_width_m)


def _paths(field: FieldSettings) -> tuple[list[str], list[Path], list[float]]:
    """Names, paths and lengths [m] of the field's lines."""
    lines, arcs = field_lines(field)
    names = [*NAMES[: len(lines)], *(CIRCLE for _ in arcs)]
    paths = [*(_straight(np.array(line)) for line in lines), *(_round(arc.x_m, arc.y_m, arc.radius_m) for arc in arcs)]
    lengths = [math.hypot(line[2] - line[0], line[3] - line[1]) for line in lines]
    return names, paths, [*lengths, *(math.tau * arc.radius_m for arc in arcs)]


def _moves(path: Path, longer: Sequence[Path | None], shares: Floats) -> Floats:
    """How points of a line move with the field's measures: shape (n,) shares of its length -> (n, 2, 4).

    longer: the line's path after each measure became longer by STEP_M; None: the field has no such measure.
    """
    here = path(shares)[0]
    still = np.zeros_like(here)
    moves: Floats = (
        np.stack([still if other is None else other(shares)[0] - here for other in longer], axis=-1) / STEP_M
    )
    return moves


def sections_for(field: FieldSettings, lens: Lens) -> Painted:
    """The field's lines in sections of the right length for the picture of a lens."""
    return painted_sections(field, lens.focal_px / lens.position_m[2])


def placed(painted: Painted, lens: Lens) -> Placed:
    """Where a lens sees sections; nan where it does not."""
    count = len(painted)
    shift = painted.moves @ lens.stretch
    points = lens.project((painted.points_m + shift[:, None]).reshape(-1, 2)).reshape(count, POINTS_PER_SECTION, 2)
    half = painted.across * painted.width_m / 2.0
    middles = painted.middles_m + shift
    along = np.column_stack([-painted.across[:, 1], painted.across[:, 0]]) * STEP_M
    ahead = lens.project(middles + along) - lens.project(middles - along)
    edge = lens.project(middles + half) - lens.project(middles - half)
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = np.column_stack([-ahead[:, 1], ahead[:, 0]]) / np.hypot(*ahead.T)[:, None]
    widths = (edge * normals).sum(axis=1)
    return Placed(points, normals * np.sign(widths)[:, None], np.abs(widths) / 2.0, painted.inward)


def _straight(line: Floats) -> Path:
    start, end = line[:2], line[2:]
    along = (end - start) / np.hypot(*(end - start))
    normal = np.array([-along[1], along[0]])

    def path(shares: Floats) -> tuple[Floats, Floats]:
        return start + shares[:, None] * (end - start), np.tile(normal, (len(shares), 1))

    return path


def _round(x_m: float, y_m: float, radius_m: float) -> Path:
    def path(shares: Floats) -> tuple[Floats, Floats]:
        outward = np.column_stack([np.cos(math.tau * shares), np.sin(math.tau * shares)])
        return np.array([x_m, y_m]) + radius_m * outward, outward

    return path
