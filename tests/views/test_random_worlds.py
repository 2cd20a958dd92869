"""All rules of ``vision_core.views`` at once: compiled code against `brute_force` on random worlds."""

import math
from collections import Counter

import numpy as np
import pytest

from tests.views import brute_force
from tests.views.scenes import BALL_RADIUS, Observer, fields, random_world, with_squares
from vision_core.models.field import accepted_half_extent, field_segments
from vision_core.models.from_settings import robots_of
from vision_core.settings.schema import FieldSettings
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.tracks import World

SETTINGS = with_squares()
SHAPES = {team: robots_of(SETTINGS.robots, team) for team in Team}
SLICES = 200
FINE_SLICES = 200_000


def scene_of(world: World, field: FieldSettings) -> brute_force.Scene:
    """The world as seen by its first robot, blue 1."""
    own, others, things = world.robots[0], world.robots[1:], world.obstacles
    squares = [SHAPES[r.team].outline == "square" and r.heading_sd_rad < 1.0 for r in others]
    first = {Team.BLUE: EdgeKind.ROBOT_BLUE, Team.YELLOW: EdgeKind.ROBOT_YELLOW}
    segments = field_segments(field, "left")
    solid, virtual = ([s for s in segments if s.solid is flag] for flag in (True, False))
    return brute_force.Scene(
        x=own.x_m,
        y=own.y_m,
        solid=np.array([(s.x1_m, s.y1_m, s.x2_m, s.y2_m) for s in solid]).reshape(-1, 4),
        solid_kinds=np.array([s.kind for s in solid], dtype=np.uint8),
        virtual=np.array([(s.x1_m, s.y1_m, s.x2_m, s.y2_m) for s in virtual]).reshape(-1, 4),
        virtual_kinds=np.array([s.kind for s in virtual], dtype=np.uint8),
        half_extent=accepted_half_extent(field),
        robots=np.array([(r.x_m, r.y_m) for r in others] + [(thing.x_m, thing.y_m) for thing in things]).reshape(-1, 2),
        robot_kinds=np.array(
            [first[r.team] + (r.id or 0) for r in others] + [EdgeKind.UNKNOWN] * len(things), dtype=np.uint8
        ),
        radii=np.array([SHAPES[r.team].radius_m for r in others] + [thing.radius_m for thing in things]),
        headings=np.array(
            [r.heading_rad if square else math.nan for r, square in zip(others, squares, strict=True)]
            + [math.nan] * len(things)
        ),
        r_min=SHAPES[own.team].radius_m,
    )


def check_ball(world: World, scene: brute_force.Scene, partial: bool | None) -> str:
    """Assert that brute force agrees. Returns what it finds; partial: None for hidden."""
    assert world.ball is not None
    place = (world.ball.x_m, world.ball.y_m)
    expected = {None: "hidden", True: "partial", False: "whole"}[partial]
    for slices in (SLICES, FINE_SLICES):  # a visible or hidden sliver may fall between the slices
        visible = brute_force.ball_slices(scene, place, BALL_RADIUS, slices)
        found = "whole" if visible.all() else "partial" if visible.any() else "hidden"
        if found == expected:
            break
    assert found == expected, f"{world}"
    return found


def compare(count: int, seed: int) -> Counter[str]:
    """Compare so many worlds, on each kind of field in turn; how often each case occurred."""
    rng = np.random.default_rng(seed)
    kinds = list(fields().values())
    observers = [Observer(field, SETTINGS) for field in kinds]
    met: Counter[str] = Counter()
    for number in range(count):
        field, eye = kinds[number % len(kinds)], observers[number % len(kinds)]
        world = random_world(rng, field)
        view = eye.observe(world, Team.BLUE, 1)
        assert view is not None
        scene = scene_of(world, field)
        distances, edge_kinds = brute_force.edges(np.radians(np.arange(360.0)) + world.robots[0].heading_rad, scene)
        np.testing.assert_allclose(view.distances_m, distances, rtol=0.0, atol=1e-6, err_msg=f"{world}")
        np.testing.assert_array_equal(view.kinds, edge_kinds, err_msg=f"{world}")
        assert view.overlap == bool(brute_force.holding(scene).any())
        met["overlap"] += view.overlap
        met["obstacle"] += bool((view.kinds == EdgeKind.UNKNOWN).any())
        met["nothing"] += bool((view.kinds == EdgeKind.NOTHING).any())
        if world.ball is None:
            assert view.ball is None
            continue
        met[check_ball(world, scene, None if view.ball is None else view.ball.partial)] += 1
        if view.ball is not None:
            d = math.hypot(world.ball.x_m - scene.x, world.ball.y_m - scene.y)
            assert view.ball.distance_m == pytest.approx(d)
            half = math.radians(view.ball.size_deg / 2.0)
            assert d * math.sin(half) == pytest.approx(min(BALL_RADIUS, d))
    return met


def test_300_random_worlds_agree_with_brute_force() -> None:
    compare(300, seed=1)


@pytest.mark.slow
def test_10000_random_worlds_agree_with_brute_force() -> None:
    met = compare(10_000, seed=2)
    for event in ("overlap", "obstacle", "nothing", "hidden", "partial", "whole"):
        assert met[event] >= 100, f"the worlds hardly ever show: {event}; {met}"
