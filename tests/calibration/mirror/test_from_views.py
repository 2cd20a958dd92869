"""One on-board picture and what stands around the robot give hundreds of pairs, and the mirror."""

import numpy as np
import pytest
from msgspec.structs import replace

from tests.calibration.mirror.pictures import around
from tests.capture.synthetic.scenes import plain_settings
from vision_core.calibration.mirror.fit import radii_of
from vision_core.calibration.mirror.from_views import Surroundings, pairs_around
from vision_core.calibration.mirror.result import MirrorCalibration
from vision_core.calibration.mirror.verdict import SPAN_MM, calibrate_mirror
from vision_core.calibration.result import Cancelled
from vision_core.capture.synthetic.world import World
from vision_core.clock import Instant
from vision_core.errors import SourceError
from vision_core.geometry import Floats
from vision_core.models.field import field_of_floor
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import MM_PER_M, PAPER_MIRROR, Mirror
from vision_core.onboard.camera import OnboardCamera
from vision_core.onboard.scene import snapshot_of
from vision_core.onboard.truth import first_solids
from vision_core.types.objects import Team
from vision_core.types.views import RobotView
from vision_core.venues.loader import load_settings

DIRECTIONS = np.arange(360.0)
ROBOTS = np.array(
    [
        (0.5, 0.2, 0.7), (0.78, 0.2, 0.0), (0.6, -0.2, 1.0), (0.1, 0.55, 2.0), (-0.3, -0.3, 0.5),
        (0.52, 0.45, 1.2), (1.2, 0.6, 0.1), (-0.9, 0.5, 0.0), (0.9, -0.7, 0.3), (-0.5, -0.9, 0.2),
    ]
)  # fmt: skip


def walls_mm() -> Floats:
    """Distances of the walls of a field of 4 by 3 m from a place beside its middle, and of an obstacle."""
    angle = np.radians(DIRECTIONS)
    x = np.where(np.cos(angle) > 0.0, 2600.0, 1400.0) / np.abs(np.cos(angle)).clip(1e-9)
    y = np.where(np.sin(angle) > 0.0, 900.0, 2100.0) / np.abs(np.sin(angle)).clip(1e-9)
    walls: Floats = np.minimum(x, y)
    walls[40:80] = 250.0 + np.abs(np.arange(-20.0, 20.0)) * 4.0
    return walls


def test_a_drawn_picture_with_a_painted_line_and_a_few_wrong_distances() -> None:
    walls = walls_mm()
    picture = around(PAPER_MIRROR.px_from_mm(walls), line_px=40.0)
    said = walls.copy()
    said[100:115], said[200:210] = 700.0, np.inf
    pairs = pairs_around(picture, Surroundings(np.radians(DIRECTIONS), said), name="a.png").pairs
    assert len(pairs) > 300
    assert "a.png at 42 degrees" in pairs.names
    result = calibrate_mirror(pairs, None)
    assert result.accepted, result.reasons
    assert result.mirror is not None
    assert np.abs(result.mirror.px_from_mm(SPAN_MM) - PAPER_MIRROR.px_from_mm(SPAN_MM)).max() < 0.3


def test_a_view_of_the_ceiling_camera_says_what_stands_around() -> None:
    kinds = np.zeros(720, dtype=np.uint8)
    distances = np.repeat([1.0, np.inf], 360)
    found = Surroundings.of(RobotView(Team.BLUE, 1, Instant(0), 1, distances, kinds, None, overlap=False))
    assert found.directions_rad[180] == pytest.approx(np.pi / 2.0)
    assert found.known().distances_mm.tolist() == [1000.0] * 360


def test_what_does_not_fit_is_refused() -> None:
    walls = walls_mm()
    picture = around(PAPER_MIRROR.px_from_mm(walls))
    surroundings = Surroundings(np.radians(DIRECTIONS), walls[::-1].copy())
    with pytest.raises(SourceError, match=r"in \d+ of 360 directions .* heading up in the picture"):
        pairs_around(picture, surroundings)
    with pytest.raises(SourceError, match="in 0 of 0 directions"):
        pairs_around(picture, Surroundings(np.radians(DIRECTIONS), np.full(360, np.inf)))
    with pytest.raises(SourceError, match="in 0 of 360 directions"):
        pairs_around(np.full_like(picture, 90), Surroundings(np.radians(DIRECTIONS), walls))


def test_it_is_cancelled() -> None:
    def progress(_what: str, share: float) -> None:
        if share > 0.2:
            raise Cancelled

    with pytest.raises(Cancelled):
        pairs_around(around(np.full(360, 80.0)), Surroundings(np.radians(DIRECTIONS), walls_mm()), progress=progress)


@pytest.mark.slow
def test_a_line_along_near_walls_is_known_or_counts_in_the_band() -> None:
    """A robot beside walls with a painted line of 3 mm: its inner edge is where the floor ends."""
    settings = load_settings("demo-vsss", options={"synthetic.seed": 2})
    world, camera = World(settings), OnboardCamera(settings, (Team.BLUE, 1))
    floor = OnboardCamera(replace(settings, field=field_of_floor(settings.field)), (Team.BLUE, 1))
    world.advance(3.0)
    snapshot = world.snapshot()
    picture = camera.picture(camera.scene(snapshot))
    results = []
    for measure in (camera, floor):
        feet = np.array(first_solids(measure.scene(snapshot), DIRECTIONS).foot_mm)
        feet[feet < camera.nearest_floor_m * MM_PER_M] = np.inf
        pairs = pairs_around(picture, Surroundings(np.radians(DIRECTIONS), feet), scale=camera.scale).pairs
        results.append(calibrate_mirror(pairs, None))
    walls, ends = results
    assert error_px(walls, camera.mirror) > 0.8, "the line is taken for the wall"
    assert error_px(walls, camera.mirror) < walls.band_px
    assert error_px(ends, camera.mirror) < 0.3


def error_px(result: MirrorCalibration, mirror: Mirror) -> float:
    """Largest error of the curve."""
    assert result.shape is not None
    return float(np.abs(radii_of(result.shape, SPAN_MM) - mirror.px_from_mm(SPAN_MM)).max())


@pytest.mark.slow
@pytest.mark.parametrize(
    "mirror",
    [PAPER_MIRROR, Hyperboloid(500.0, 150.0, 1.6).mirror(), Hyperboloid(150.0, 300.0, 1.2).mirror()],
    ids=["paper", "vsss", "short"],
)
def test_a_mirror_is_recovered_from_one_rendered_picture(mirror: Mirror) -> None:
    settings = plain_settings(synthetic__robots_per_team=5, synthetic__walking_people=0, field__margin_m=0.1)
    camera = OnboardCamera(settings, (Team.BLUE, 1), mirror=mirror)
    scene = camera.scene(snapshot_of(ROBOTS, (-1.0, -0.2)))
    feet = np.array(first_solids(scene, DIRECTIONS).foot_mm)
    feet[feet < camera.nearest_floor_m * MM_PER_M] = np.inf
    around_robot = Surroundings(np.radians(DIRECTIONS), feet)
    pairs = pairs_around(camera.exact_picture(scene), around_robot, scale=camera.scale).pairs
    assert len(pairs) > 300
    result = calibrate_mirror(pairs, None)
    assert result.accepted, result.reasons
    assert error_px(result, mirror) < 0.3
