"""The exact edges agree with the views where both model the same thing."""

import numpy as np
import pytest

from tests.onboard.scenes import Lab, lone_pair
from vision_core.clock import Instant
from vision_core.onboard.scene import Scene
from vision_core.onboard.truth import first_solids
from vision_core.settings.schema import Settings
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.tables import WorldTable
from vision_core.types.tracks import RobotTrack, World
from vision_core.views.renderer import ViewRenderer

AT = Instant(1)
GOALS = [int(EdgeKind.GOAL_BLUE), int(EdgeKind.GOAL_YELLOW)]


def settings_of(field: str) -> Settings:
    """Square robots: the outlines of both are the same."""
    options = {"robots__outline": "square", "robots__radius_m": 0.04}
    return lone_pair(field_preset=field, **options)


@pytest.mark.parametrize("field", ["ssl-2002", "vsss", "ssl-division-b"])
def test_the_nearest_edges_are_those_of_the_view(field: str) -> None:
    settings = settings_of(field)
    lab, renderer = Lab(settings), ViewRenderer(settings)
    rng = np.random.default_rng(5)
    half = np.array([settings.field.length_m, settings.field.width_m]) / 2.0 - 0.1
    for _ in range(20):
        robots = np.column_stack([rng.uniform(-half, half, size=(2, 2)), rng.uniform(-3.0, 3.0, size=2)])
        tracks = tuple(
            RobotTrack(team, marker, x, y, heading, 0.0, 0.0, 0.0, 0.001, 0.01, 1.0, AT)
            for (team, marker), (x, y, heading) in zip(lab.camera.worn, robots.tolist(), strict=True)
        )
        table = WorldTable.of(World(1, AT, tracks, None, ()))
        renderer.render(table)
        view = renderer.view(table, Team.BLUE, 1)
        assert view is not None
        seen = first_solids(lab.scene(*map(tuple, robots.tolist())), np.arange(360.0))
        # boards have a thickness: a goal on an open field is larger from outside, and walls have ends at its mouth
        same = np.isclose(seen.foot_mm, 1000.0 * view.distances_m, atol=1e-6)
        assert same.all() if settings.field.walls else same.mean() > 0.98
        assert np.isin(seen.kinds[~same], GOALS).all()
        other = same & (seen.kinds != view.kinds)
        assert (seen.kinds[other] == EdgeKind.WALL).all()
        assert np.isin(view.kinds[other], GOALS).all()
        assert other.mean() < 0.02


def test_the_flat_front_of_a_round_robot_is_nearer_than_its_radius() -> None:
    lab = Lab(lone_pair())
    scene = lab.scene((0.0, 0.0, 0.0), (0.5, 0.0, np.pi))
    seen = first_solids(scene, np.array([0.0, 180.0]))
    assert seen.foot_mm[0] == pytest.approx(500.0 - 55.0)
    assert seen.kinds[0] == EdgeKind.ROBOT_YELLOW + 1
    assert seen.kinds[1] == EdgeKind.GOAL_BLUE
    assert scene.solids[int(seen.solids[0])]["kind"] == EdgeKind.ROBOT_YELLOW + 1


def test_a_virtual_limit_hides_nothing() -> None:
    lab = Lab(lone_pair(field_preset="ssl-division-b"))
    scene: Scene = lab.scene((0.0, 2.9, 0.0), (0.0, 3.45, 0.0))
    seen = first_solids(scene, np.array([90.0, 45.0]))
    assert seen.kinds[0] == EdgeKind.ROBOT_YELLOW + 1
    assert seen.kinds[1] == EdgeKind.WALL
    assert seen.solids[1] == -1
    assert seen.foot_mm[1] == seen.clear_mm[1] == pytest.approx(np.sqrt(2.0) * (3.48 - 2.9) * 1000.0)
