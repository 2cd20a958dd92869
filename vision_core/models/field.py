"""The field as geometry: its segments, which make edges, and its painted lines and arcs.

Field space, see ``geometry``. Left is the goal at negative x.
"""

import math

import numpy as np
from msgspec.structs import replace

from vision_core.geometry import Floats
from vision_core.settings.schema import FieldSettings
from vision_core.types.edges import EdgeKind
from vision_core.types.field import Arc, Segment

Line = tuple[float, float, float, float]
"""x1, y1, x2, y2 [m]: the middle of a painted line."""


def field_segments(field: FieldSettings, blue_defends: str) -> tuple[Segment, ...]:
    """Every segment of the field that makes edges.

    With walls: solid walls at the lines plus margin (with cut corners if the preset has them), open at the
    goals' mouths; behind each mouth the goal's solid sides and back. Without walls: the solid goals, and around the
    field a virtual limit at lines + margin + goal depth, which is an edge but hides nothing.
    """
    left, right = (
        (EdgeKind.GOAL_BLUE, EdgeKind.GOAL_YELLOW)
        if blue_defends == "left"
        else (EdgeKind.GOAL_YELLOW, EdgeKind.GOAL_BLUE)
    )
    goals = (*_goal(field, -1.0, left), *_goal(field, 1.0, right))
    return (*goals, *(_walls(field) if field.walls else _limit(field)))


def line_at_walls_m(field: FieldSettings) -> float:
    """Width of the line that is painted at the feet of a field's walls [m]; 0: no walls, or they keep off the lines."""
    return field.line_width_m if field.walls and field.margin_m == 0.0 else 0.0


def field_of_floor(field: FieldSettings) -> FieldSettings:
    """The field whose walls stand where the bare floor ends: at the inner edge of lines that are painted at their feet.

    Cut corners have no line, and goals none inside.
    """
    line = line_at_walls_m(field)
    return replace(
        field,
        length_m=field.length_m - 2.0 * line,
        width_m=field.width_m - 2.0 * line,
        corner_cut_m=max(field.corner_cut_m - 2.0 * line, 0.0),
        goal=replace(field.goal, depth_m=field.goal.depth_m + line),
    )


def goal_line_x(field: FieldSettings) -> float:
    """Distance of a goal's mouth from the center line [m]: it is in the wall, or on the goal line."""
    return field.length_m / 2.0 + (field.margin_m if field.walls else 0.0)


def accepted_half_extent(field: FieldSettings) -> tuple[float, float]:
    """Half length and half width of the area inside the walls or limits [m], goals not counted."""
    beyond = field.margin_m + (0.0 if field.walls else field.goal.depth_m)
    return field.length_m / 2.0 + beyond, field.width_m / 2.0 + beyond


def diagonal_m(field: FieldSettings) -> float:
    """The longest distance inside the walls or limits [m]."""
    return 2.0 * math.hypot(*accepted_half_extent(field))


def is_accepted(field: FieldSettings, x_m: float, y_m: float) -> bool:
    """Whether a ball may be at a point: on the field, on its margin or in a goal."""
    half_x, half_y = accepted_half_extent(field)
    if abs(x_m) <= half_x and abs(y_m) <= half_y:
        return True
    return abs(x_m) <= goal_line_x(field) + field.goal.depth_m and abs(y_m) <= field.goal.width_m / 2.0


def field_lines(field: FieldSettings) -> tuple[tuple[Line, ...], tuple[Arc, ...]]:
    """The painted lines (their middles) and arcs; none on a field without line width."""
    if not field.line_width_m:
        return (), ()
    inset = field.line_width_m / 2.0
    x, y = field.length_m / 2.0 - inset, field.width_m / 2.0 - inset
    lines: list[Line] = [(-x, -y, x, -y), (-x, y, x, y), (-x, -y, -x, y), (x, -y, x, y), (0.0, -y, 0.0, y)]
    if field.penalty_depth_m and field.penalty_width_m:
        deep, wide = x - field.penalty_depth_m, field.penalty_width_m / 2.0
        for side in (-1.0, 1.0):
            lines += [
                (side * x, -wide, side * deep, -wide),
                (side * deep, -wide, side * deep, wide),
                (side * deep, wide, side * x, wide),
            ]
    radius = field.center_circle_radius_m
    arcs = (Arc(0.0, 0.0, radius, 0.0, math.tau),) if radius else ()
    return tuple(lines), arcs


def painted_points(field: FieldSettings, per_line: int) -> list[Floats]:
    """Points along every painted line: an array of shape (per_line, 2) [m]; of an arc, shape (2 * per_line, 2)."""
    lines, arcs = field_lines(field)
    along = [np.linspace(line[:2], line[2:], per_line) for line in lines]
    return [*along, *(_points_on(arc, 2 * per_line) for arc in arcs)]


def _points_on(arc: Arc, count: int) -> Floats:
    angles = np.linspace(arc.start_rad, arc.end_rad, count)
    return np.column_stack([arc.x_m + arc.radius_m * np.cos(angles), arc.y_m + arc.radius_m * np.sin(angles)])


def _goal(field: FieldSettings, side: float, kind: EdgeKind) -> tuple[Segment, ...]:
    wide, deep = field.goal.width_m / 2.0, field.goal.depth_m
    if not wide or not deep:
        return ()
    mouth = side * goal_line_x(field)
    back = side * (goal_line_x(field) + deep)
    return (
        Segment(mouth, -wide, back, -wide, kind, True),
        Segment(back, -wide, back, wide, kind, True),
        Segment(back, wide, mouth, wide, kind, True),
    )


def _walls(field: FieldSettings) -> tuple[Segment, ...]:
    x, y = accepted_half_extent(field)
    cut, wide = field.corner_cut_m, field.goal.width_m / 2.0
    wide = wide if field.goal.depth_m else 0.0
    pieces = []
    for side in (-1.0, 1.0):
        pieces.append((-x + cut, side * y, x - cut, side * y))
        for up in (-1.0, 1.0):
            pieces.append((side * x, up * wide, side * x, up * (y - cut)))
            if cut:
                pieces.append((side * x, up * (y - cut), side * (x - cut), up * y))
    return tuple(Segment(*piece, EdgeKind.WALL, True) for piece in pieces)


def _limit(field: FieldSettings) -> tuple[Segment, ...]:
    x, y = accepted_half_extent(field)
    sides = ((-x, -y, x, -y), (x, -y, x, y), (x, y, -x, y), (-x, y, -x, -y))
    return tuple(Segment(*side, EdgeKind.WALL, False) for side in sides)
