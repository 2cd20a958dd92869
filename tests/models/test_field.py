"""The field as segments: closed where it must be, open at the goals."""

import math

import pytest
from msgspec.structs import replace

from vision_core.models.field import (
    accepted_half_extent,
    field_lines,
    field_of_floor,
    field_segments,
    goal_line_x,
    is_accepted,
    line_at_walls_m,
)
from vision_core.settings.schema import FieldSettings
from vision_core.types.edges import EdgeKind
from vision_core.types.field import Segment
from vision_core.venues.loader import load_settings

WALLED = load_settings(options={"field_preset": "ssl-2002"}).field
OPEN = load_settings(options={"field_preset": "ssl-division-b"}).field
CUT = replace(WALLED, corner_cut_m=0.12, margin_m=0.05)
FIELDS = [WALLED, OPEN, CUT]


def ends(segments: list[Segment]) -> dict[tuple[float, float], int]:
    """How many segments end at each point."""
    counted: dict[tuple[float, float], int] = {}
    for s in segments:
        for x, y in ((s.x1_m, s.y1_m), (s.x2_m, s.y2_m)):
            place = (round(x, 9), round(y, 9))
            counted[place] = counted.get(place, 0) + 1
    return counted


@pytest.mark.parametrize("field", [WALLED, CUT], ids=["walls", "cut corners"])
def test_walls_and_goals_are_one_closed_solid_line(field: FieldSettings) -> None:
    segments = list(field_segments(field, "left"))
    assert all(segment.solid for segment in segments)
    assert set(ends(segments).values()) == {2}


def slanted(field: FieldSettings) -> set[float]:
    """|x| + |y| of a field's cut corners."""
    walls = [s for s in field_segments(field, "left") if abs(s.x1_m - s.x2_m) == pytest.approx(abs(s.y1_m - s.y2_m))]
    return {round(abs(s.x1_m) + abs(s.y1_m), 6) for s in walls}


def test_the_floor_ends_before_the_lines_at_walls_and_in_the_goals_where_it_did() -> None:
    walled, floor = (field_segments(one, "left") for one in (WALLED, field_of_floor(WALLED)))
    backs = [max(abs(s.x1_m) for s in segments if s.kind is not EdgeKind.WALL) for segments in (walled, floor)]
    walls = [max(abs(s.y1_m) for s in segments if s.kind is EdgeKind.WALL) for segments in (walled, floor)]
    assert backs[0] == pytest.approx(backs[1])
    assert walls[0] == pytest.approx(walls[1] + WALLED.line_width_m)
    cut = replace(WALLED, corner_cut_m=0.12)
    corners = [slanted(one) for one in (cut, field_of_floor(cut))]
    assert corners[0] == corners[1], "no line is painted along cut corners"
    assert field_of_floor(OPEN) == OPEN
    assert [line_at_walls_m(field) for field in (WALLED, OPEN, CUT)] == [WALLED.line_width_m, 0.0, 0.0]


def test_the_limit_is_closed_and_virtual_and_beyond_the_goals() -> None:
    limit = [segment for segment in field_segments(OPEN, "left") if not segment.solid]
    assert {segment.kind for segment in limit} == {EdgeKind.WALL}
    assert ends(limit) == {(x, y): 2 for x in (-4.98, 4.98) for y in (-3.48, 3.48)}


@pytest.mark.parametrize("field", FIELDS, ids=["walls", "open", "cut corners"])
def test_the_field_is_the_same_from_both_sides(field: FieldSettings) -> None:
    turned = {
        (round(-x, 9) + 0.0, round(-y, 9) + 0.0): n for (x, y), n in ends(list(field_segments(field, "left"))).items()
    }
    assert turned == ends(list(field_segments(field, "left")))


@pytest.mark.parametrize(("defends", "side"), [("left", -1.0), ("right", 1.0)])
def test_goals_belong_to_who_defends_them(defends: str, side: float) -> None:
    for segment in field_segments(WALLED, defends):
        if segment.kind is EdgeKind.GOAL_BLUE:
            assert math.copysign(1.0, segment.x2_m) == side
        if segment.kind is EdgeKind.GOAL_YELLOW:
            assert math.copysign(1.0, segment.x2_m) == -side


def test_a_field_without_goals_is_closed() -> None:
    bare = replace(WALLED, goal=replace(WALLED.goal, width_m=0.0, depth_m=0.0))
    segments = list(field_segments(bare, "left"))
    assert {segment.kind for segment in segments} == {EdgeKind.WALL}
    assert all(count == 2 for count in ends(segments).values())


def test_positions_of_goal_mouths_and_limits() -> None:
    assert goal_line_x(CUT) == pytest.approx(1.45)  # in the wall
    assert goal_line_x(OPEN) == pytest.approx(4.5)  # on the line
    assert accepted_half_extent(CUT) == pytest.approx((1.45, 1.2))
    assert accepted_half_extent(OPEN) == pytest.approx((4.98, 3.48))


@pytest.mark.parametrize(
    ("x", "y", "accepted"),
    [
        (0.0, 0.0, True),
        (1.39, 1.14, True),
        (1.41, 1.0, False),
        (1.5, 0.29, True),
        (1.5, 0.31, False),
        (1.6, 0.0, False),
    ],
)
def test_where_a_ball_may_be(x: float, y: float, accepted: bool) -> None:
    assert is_accepted(WALLED, x, y) is accepted
    assert is_accepted(WALLED, -x, -y) is accepted


def test_a_ball_just_outside_the_lines_is_accepted() -> None:
    assert is_accepted(OPEN, 4.6, 0.0)
    assert is_accepted(OPEN, 0.0, 3.4)
    assert not is_accepted(OPEN, 0.0, 3.5)


def test_lines_lie_inside_the_dimensions_of_the_field() -> None:
    lines, arcs = field_lines(WALLED)
    assert max(abs(value) for line in lines for value in line) == pytest.approx(1.4 - 0.005)
    assert len(lines) == 11
    assert [arc.radius_m for arc in arcs] == [0.25]
    bare = replace(WALLED, penalty_depth_m=0.0, center_circle_radius_m=0.0)
    assert [len(part) for part in field_lines(bare)] == [5, 0]
