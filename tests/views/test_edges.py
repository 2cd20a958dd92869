"""One drawing per rule of ``vision_core.views`` for the edges.

Field ssl-2002 unless said: walls at x = +-1.4 and y = +-1.15, goals 0.6 wide and 0.18 deep behind their mouths in the
walls; robots of radius 0.09.
"""

import dataclasses
import math

import numpy as np
import pytest
from msgspec.structs import replace

from tests.views.scenes import AT, SETTINGS, Observer, fields, obstacle, robot, with_squares, world
from vision_core.settings.schema import FieldSettings, ViewSettings
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.tracks import World
from vision_core.types.views import RobotView

FIELDS = fields()
WALLED = Observer(FIELDS["walls"])
OPEN = Observer(FIELDS["open"])
"""Lines at 1.5, 1.0; limit at +-(1.5 + 0.3 + 0.18), +-(1.0 + 0.3 + 0.18); goals 1.0 wide at x = +-1.5..1.68."""


def view_of(world: World, observer: Observer = WALLED, team: Team = Team.BLUE, number: int = 1) -> RobotView:
    view = observer.observe(world, team, number)
    assert view is not None
    return view


def edge(view: RobotView, direction: int) -> tuple[float, int]:
    return round(float(view.distances_m[direction]), 9), int(view.kinds[direction])


def test_walls_and_goals_all_round() -> None:
    #   +----------90----------+   heading along x, from the center
    #  [u         180  o 0     v]
    #   +---------270----------+
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.0)))
    assert edge(view, 0) == (1.58, EdgeKind.GOAL_YELLOW)  # the mouth is open: its back
    assert edge(view, 180) == (1.58, EdgeKind.GOAL_BLUE)
    assert edge(view, 90) == (1.15, EdgeKind.WALL)
    assert edge(view, 270) == (1.15, EdgeKind.WALL)
    assert edge(view, 45) == (round(1.15 * math.sqrt(2.0), 9), EdgeKind.WALL)
    assert view.at == AT
    assert view.frame_number == 7


def test_direction_i_is_i_degrees_anticlockwise_from_the_heading() -> None:
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.0, math.pi / 2)))  # looks along y
    assert edge(view, 0) == (1.15, EdgeKind.WALL)
    assert edge(view, 90) == (1.58, EdgeKind.GOAL_BLUE)
    assert edge(view, 270) == (1.58, EdgeKind.GOAL_YELLOW)


def test_goals_belong_to_the_team_that_defends_them_and_follow_a_change_of_sides() -> None:
    s = SETTINGS
    changed = Observer(FIELDS["walls"], replace(s, match=replace(s.match, blue_defends="right")))
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.0)), changed)
    assert edge(view, 0)[1] == EdgeKind.GOAL_BLUE
    assert edge(view, 180)[1] == EdgeKind.GOAL_YELLOW


def test_inner_sides_of_a_goal() -> None:
    # half-way between mouth and back, in its middle: sides at 0.3, back at 0.09
    view = view_of(world(robot(Team.BLUE, 1, 1.49, 0.0)))
    assert edge(view, 90) == (0.3, EdgeKind.GOAL_YELLOW)
    assert edge(view, 270) == (0.3, EdgeKind.GOAL_YELLOW)
    assert edge(view, 0) == (0.09, EdgeKind.GOAL_YELLOW)


def test_corner_cuts_are_walls() -> None:
    # corner at (1.45, 1.20), cut by 0.12: the line x + y = 1.45 + 1.20 - 0.12
    view = view_of(world(robot(Team.BLUE, 1, 1.0, 0.8)), Observer(FIELDS["corners"]))
    assert edge(view, 45) == (round((2.53 - 1.8) / math.sqrt(2.0), 9), EdgeKind.WALL)


def test_a_robot_is_a_circle_and_hides_the_wall() -> None:
    # o  (#)  |   center 0.5 away, radius 0.09: near side at 0.41, half width asin(0.18) = 10.4 degrees
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.YELLOW, 3, 0.0, 0.5)))
    assert edge(view, 90) == (0.41, EdgeKind.ROBOT_YELLOW + 3)
    reached = np.nonzero(view.kinds == EdgeKind.ROBOT_YELLOW + 3)[0]
    assert (reached.min(), reached.max()) == (80, 100)
    expected = 0.5 * math.cos(math.radians(10)) - math.sqrt(0.09**2 - (0.5 * math.sin(math.radians(10))) ** 2)
    assert view.distances_m[80] == pytest.approx(expected)


def test_of_two_robots_the_nearer_one_is_the_edge() -> None:
    own, near, far = (
        robot(Team.BLUE, 1, 0.0, 0.0),
        robot(Team.BLUE, 2, 0.4, 0.0),
        robot(Team.YELLOW, 2, 0.8, 0.0),
    )
    for order in ((own, near, far), (far, near, own)):
        assert edge(view_of(world(*order)), 0) == (0.31, EdgeKind.ROBOT_BLUE + 2)


def test_the_own_outline_is_no_edge() -> None:
    view = view_of(world(robot(Team.BLUE, 1, 0.3, 0.2)))
    assert set(view.kinds.tolist()) == {EdgeKind.WALL, EdgeKind.GOAL_BLUE, EdgeKind.GOAL_YELLOW}


def test_kinds_are_numbers_by_the_map_of_the_match() -> None:
    s = SETTINGS
    match = replace(s.match, blue_ids=(11, 7, 0), yellow_ids=(5, 6), numbers=2)
    observer = Observer(FIELDS["walls"], replace(s, match=match))
    robots = [robot(Team.BLUE, 11, 0.0, 0.0)]
    others = [(Team.BLUE, 7), (Team.BLUE, 0), (Team.BLUE, None), (Team.BLUE, 1), (Team.YELLOW, 6), (Team.YELLOW, None)]
    for k, (team, marker) in enumerate(others):
        robots.append(robot(team, marker, 0.8 * math.cos(k), 0.8 * math.sin(k)))
    view = observer.observe(world(*robots), Team.BLUE, 1)
    assert view is not None
    blue, yellow = EdgeKind.ROBOT_BLUE, EdgeKind.ROBOT_YELLOW
    directions = np.degrees(np.arange(len(others))).round().astype(int)
    assert view.kinds[directions].tolist() == [blue + 2, blue + 3, blue, blue, yellow + 2, yellow]
    assert observer.observe(world(*robots), Team.BLUE, 3) is None  # connected are numbers 1 and 2 alone


@pytest.mark.parametrize(("team", "number"), [(Team.BLUE, 2), (Team.YELLOW, 1), (Team.BLUE, 0), (Team.BLUE, 17)])
def test_a_robot_that_is_not_in_the_world_has_no_view(team: Team, number: int) -> None:
    here = world(robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.YELLOW, None, 0.5, 0.0))
    assert WALLED.observe(here, team, number) is None


def test_number_sixteen_has_id_zero() -> None:
    full_teams = Observer(FIELDS["walls"], replace(SETTINGS, match=replace(SETTINGS.match, numbers=16)))
    view = view_of(world(robot(Team.YELLOW, 0, 0.0, 0.0)), full_teams, Team.YELLOW, 16)
    assert (view.team, view.number) == (Team.YELLOW, 16)


def test_edges_nearer_than_r_min_are_reported_there() -> None:
    # the center 0.05 from the wall
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 1.1)))
    assert edge(view, 90) == (0.09, EdgeKind.WALL)
    assert edge(view, 30) == (0.1, EdgeKind.WALL)  # 0.05 / sin 30
    s = SETTINGS
    nearer = Observer(FIELDS["walls"], replace(s, views=ViewSettings(r_min_m=0.02)))
    assert edge(view_of(world(robot(Team.BLUE, 1, 0.0, 1.1)), nearer), 90) == (0.05, EdgeKind.WALL)


def test_robots_in_contact_are_seen_at_r_min() -> None:
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.YELLOW, 2, 0.17, 0.0)))
    assert edge(view, 0) == (0.09, EdgeKind.ROBOT_YELLOW + 2)
    assert edge(view, 180) == (1.58, EdgeKind.GOAL_BLUE)
    assert not view.overlap


@pytest.mark.parametrize("distance", [0.0, 1e-300, 0.05, 0.09])
def test_a_robot_over_the_center_is_all_round(distance: float) -> None:
    here = world(robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.YELLOW, 2, distance, 0.0), robot(Team.BLUE, 3, 0.3, 0.0))
    view = view_of(here)
    assert view.overlap
    assert set(view.distances_m.tolist()) == {0.09}
    assert set(view.kinds.tolist()) == {EdgeKind.ROBOT_YELLOW + 2}


def test_of_two_robots_over_the_center_it_is_the_nearer_one() -> None:
    own = robot(Team.BLUE, 1, 0.0, 0.0)
    view = view_of(world(own, robot(Team.YELLOW, 2, 0.08, 0.0), robot(Team.YELLOW, 4, 0.0, -0.06)))
    assert set(view.kinds.tolist()) == {EdgeKind.ROBOT_YELLOW + 4}


def test_just_outside_contact_no_number_is_lost() -> None:
    for excess in 10.0 ** np.arange(-17.0, -1.0):
        view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.YELLOW, 2, 0.09 * (1.0 + excess), 0.0)))
        assert np.isfinite(view.distances_m).all()
        assert view.distances_m.min() == 0.09


def test_without_walls_the_limit_is_an_edge_from_inside() -> None:
    # lines + margin + goal depth
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.7)), OPEN)
    assert edge(view, 90) == (0.78, EdgeKind.WALL)
    assert edge(view, 0) == (1.98, EdgeKind.WALL)  # past the goal, 0.5 to either side
    assert edge(view_of(world(robot(Team.BLUE, 1, 0.0, 0.0)), OPEN), 0) == (1.68, EdgeKind.GOAL_YELLOW)


def test_a_goal_is_solid_from_behind_and_beside() -> None:
    behind = view_of(world(robot(Team.BLUE, 1, 1.85, 0.0)), OPEN)
    assert edge(behind, 180) == (0.17, EdgeKind.GOAL_YELLOW)
    beside = view_of(world(robot(Team.BLUE, 1, 1.6, 0.8)), OPEN)
    assert edge(beside, 270) == (0.3, EdgeKind.GOAL_YELLOW)


def test_a_side_of_a_goal_seen_edge_on_is_met_at_its_near_end() -> None:
    assert edge(view_of(world(robot(Team.BLUE, 1, 0.0, 0.5)), OPEN), 0) == (1.5, EdgeKind.GOAL_YELLOW)


def test_from_outside_only_solid_things_are_seen() -> None:
    outside = world(robot(Team.BLUE, 1, 0.0, 1.6), robot(Team.YELLOW, 2, 0.0, 0.0))
    view = view_of(outside, OPEN)
    assert edge(view, 270) == (1.51, EdgeKind.ROBOT_YELLOW + 2)
    assert edge(view, 90) == (math.inf, EdgeKind.NOTHING)
    assert EdgeKind.WALL not in view.kinds.tolist()  # not even the far limit, from its inner side
    assert {EdgeKind.GOAL_BLUE, EdgeKind.GOAL_YELLOW} <= set(view.kinds.tolist())


def test_walls_are_seen_from_outside() -> None:
    assert edge(view_of(world(robot(Team.BLUE, 1, 0.0, 1.6))), 270) == (0.45, EdgeKind.WALL)


def test_a_robot_beyond_the_limit_lies_behind_the_edge_and_one_across_it_before() -> None:
    own = robot(Team.BLUE, 1, 0.0, 0.0)
    assert edge(view_of(world(own, robot(Team.BLUE, 2, 0.0, 1.7)), OPEN), 90) == (1.48, EdgeKind.WALL)
    assert edge(view_of(world(own, robot(Team.BLUE, 2, 0.0, 1.5)), OPEN), 90) == (1.41, EdgeKind.ROBOT_BLUE + 2)


def test_finer_rays_are_computed_and_every_so_many_th_is_the_coarse_one() -> None:
    here = world(robot(Team.BLUE, 1, 0.2, -0.3, 0.7), robot(Team.YELLOW, 2, 0.5, 0.4))
    whole = view_of(here)
    for finer in (2, 4):
        fine = WALLED.observe(here, Team.BLUE, 1, 360 * finer)
        assert fine is not None
        np.testing.assert_allclose(fine.distances_m[::finer], whole.distances_m)
        np.testing.assert_array_equal(fine.kinds[::finer], whole.kinds)
        assert len(set(fine.distances_m.tolist())) > len(set(whole.distances_m.tolist()))


@pytest.mark.parametrize("field", list(FIELDS.values()), ids=list(FIELDS))
def test_no_ray_slips_through_a_corner(field: FieldSettings) -> None:
    observer = Observer(field)
    corners = [math.atan2(1.15, 1.4), math.atan2(0.3, 1.4), math.atan2(0.3, 1.58), math.atan2(1.48, 1.98)]
    for x in np.linspace(-1.3, 1.3, 14):
        for y in np.linspace(-0.95, 0.95, 10):
            for heading in (0.0, *corners, *(math.pi - corner for corner in corners)):
                view = observer.observe(world(robot(Team.BLUE, 1, float(x), float(y), heading)), Team.BLUE, 1)
                assert view is not None
                assert np.isfinite(view.distances_m).all()


@pytest.mark.parametrize(("x", "y"), [(1.4, 1.15), (0.2, 1.15), (-1.4, 0.5), (1.4, -0.3), (1.49, 0.3)])
def test_standing_on_a_wall_or_a_post_it_is_at_r_min(x: float, y: float) -> None:
    """There the angles of its ends are too inaccurate."""
    view = view_of(world(robot(Team.BLUE, 1, x, y)))
    assert np.isfinite(view.distances_m).all()
    assert view.distances_m.min() == 0.09


def test_an_obstacle_is_an_unknown_edge_and_hides_the_wall() -> None:
    # o  (q)  |   center 0.5 away, radius 0.05
    here = dataclasses.replace(world(robot(Team.BLUE, 1, 0.0, 0.0)), obstacles=(obstacle(0.0, 0.5, 0.05),))
    view = view_of(here)
    assert edge(view, 90) == (0.45, EdgeKind.UNKNOWN)
    reached = np.nonzero(view.kinds == EdgeKind.UNKNOWN)[0]
    assert (reached.min(), reached.max()) == (85, 95)  # asin(0.05 / 0.5) = 5.7 degrees


SQUARES = Observer(FIELDS["walls"], with_squares())
"""Yellow robots are squares with sides of 0.22."""


def test_a_square_robot_turns_with_its_heading() -> None:
    #  o  [#]  then  o  <#>   center 0.5 away, half side 0.11
    own = robot(Team.BLUE, 1, 0.0, 0.0)
    straight = view_of(world(own, robot(Team.YELLOW, 2, 0.5, 0.0)), SQUARES)
    assert edge(straight, 0) == (0.39, EdgeKind.ROBOT_YELLOW + 2)
    assert edge(straight, 15) == (round(0.39 / math.cos(math.radians(15)), 9), EdgeKind.ROBOT_YELLOW + 2)
    assert edge(straight, 16)[1] != EdgeKind.ROBOT_YELLOW + 2  # atan(0.11 / 0.39) = 15.8 degrees
    turned = view_of(world(own, robot(Team.YELLOW, 2, 0.5, 0.0, math.pi / 4)), SQUARES)
    assert edge(turned, 0) == (round(0.5 - 0.11 * math.sqrt(2.0), 9), EdgeKind.ROBOT_YELLOW + 2)


def test_a_square_of_unknown_heading_is_the_circle_inside() -> None:
    blind = dataclasses.replace(robot(Team.YELLOW, 2, 0.5, 0.0, math.pi / 4), heading_sd_rad=3.0)
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.0), blind), SQUARES)
    assert edge(view, 0) == (0.39, EdgeKind.ROBOT_YELLOW + 2)
    assert int((view.kinds == EdgeKind.ROBOT_YELLOW + 2).sum()) == 25  # asin(0.11 / 0.5) = 12.7 degrees


def test_a_squares_corner_over_the_center_is_all_round() -> None:
    near = robot(Team.YELLOW, 2, 0.1, 0.1)
    assert view_of(world(robot(Team.BLUE, 1, 0.0, 0.0), near), SQUARES).overlap
    turned = dataclasses.replace(near, heading_rad=math.pi / 4)
    assert not view_of(world(robot(Team.BLUE, 1, 0.0, 0.0), turned), SQUARES).overlap


def test_r_min_is_the_own_radius() -> None:
    here = world(robot(Team.YELLOW, 1, 0.0, 1.1))  # the center 0.05 from the wall
    assert edge(view_of(here, SQUARES, Team.YELLOW), 90) == (0.11, EdgeKind.WALL)


def test_the_arrays_of_a_view_are_read_only() -> None:
    view = view_of(world(robot(Team.BLUE, 1, 0.0, 0.0)))
    for array in (view.distances_m, view.kinds):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
