"""The ceiling camera's picture says what stands around a robot, and with the robot's own picture gives its mirror."""

from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace
from typer.testing import CliRunner

from app.cli import app
from vision_core.calibration.job import MirrorJob, NamedPair, PairsJob, PictureFile
from vision_core.calibration.mirror.from_views import EDGE_PX, MEASURED_MM
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.capture.synthetic.render import Renderer
from vision_core.capture.synthetic.world import World
from vision_core.errors import SettingsError, SourceError
from vision_core.evaluation.surroundings import surroundings_in
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import field_of_floor
from vision_core.models.from_settings import mirror_of
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.native.opencv import write_picture
from vision_core.onboard.camera import OnboardCamera
from vision_core.onboard.truth import first_solids
from vision_core.settings.schema import Settings
from vision_core.startup.mirror_pairs import find_pairs, pairs_for
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow
DIRECTIONS = np.arange(360.0)


@pytest.fixture(scope="module")
def taken(tmp_path_factory: pytest.TempPathFactory) -> tuple[Settings, Path]:
    """Two instants of a match: what the ceiling camera shows, what blue 1 sees, and where the floor ends."""
    settings, folder = load_settings(options={"synthetic.seed": 0}), tmp_path_factory.mktemp("instants")
    world, camera = World(settings), CameraSetup.from_settings(settings)
    floor = replace(settings, field=field_of_floor(settings.field))
    bare = OnboardCamera(floor, (Team.BLUE, 1))
    onboard, ceiling = OnboardCamera(settings, (Team.BLUE, 1)), Renderer(settings, camera, world.robots_worn)
    pixels = np.empty((settings.camera.height_px, settings.camera.width_px, 3), dtype=np.uint8)
    for number in range(2):
        world.advance(3.0)
        snapshot = world.snapshot()
        scene = onboard.scene(snapshot)
        ceiling.draw(pixels, snapshot)
        write_picture(folder / f"ceiling-{number}.png", pixels)
        write_picture(folder / f"onboard-{number}.png", onboard.picture(scene))
        np.save(folder / f"truth-{number}.npy", first_solids(bare.scene(snapshot), DIRECTIONS).foot_mm)
    return settings, folder


def test_distances_are_those_of_the_scene(taken: tuple[Settings, Path]) -> None:
    settings, folder = taken
    found = surroundings_in(folder / "ceiling-0.png", settings, Team.BLUE, 1)
    truth = np.load(folder / "truth-0.npy")
    assert np.degrees(found.directions_rad) == pytest.approx(DIRECTIONS)
    assert np.median(np.abs(found.distances_mm - truth)) < 3.0
    assert (np.abs(found.distances_mm - truth) < 20.0).mean() > 0.9
    with pytest.raises(SourceError, match="robots by marker id: blue 1"):
        surroundings_in(folder / "ceiling-0.png", settings, Team.BLUE, 16)


def test_pictures_of_both_cameras_give_the_mirror(taken: tuple[Settings, Path], tmp_path: Path) -> None:
    _, folder = taken
    files = [
        word
        for number in range(2)
        for word in ("--picture", folder / f"onboard-{number}.png", "--around", folder / f"ceiling-{number}.png")
    ]
    result = CliRunner().invoke(app, ["calibrate", "mirror", *map(str, files), "--robot", "blue:1", "--focal", "300"])
    assert result.exit_code == 0, result.output
    venue = tmp_path / "venue.toml"
    venue.write_text(result.stdout)
    mirror = mirror_of(load_settings(str(venue)).mirror, Team.BLUE)
    distances = np.linspace(200.0, 2500.0, 40)
    assert mirror.px_from_mm(distances) == pytest.approx(PAPER_MIRROR.px_from_mm(distances), abs=0.6)


def test_a_job_takes_pairs_from_both_cameras(taken: tuple[Settings, Path]) -> None:
    settings, folder = taken
    picture = PictureFile(str(folder / "onboard-1.png"), "b.png")
    steps: list[str] = []
    job = PairsJob(settings, picture, "", str(folder / "ceiling-1.png"), Team.BLUE, 1, None, 1.0)
    found = find_pairs(job, lambda what, _share: steps.append(what))
    pairs = pairs_for(MirrorJob(settings, (NamedPair(61.5, 380.0, "the ball"), *found.pairs), Rounding.AUTO, None))
    assert pairs.names[0] == "the ball"
    assert pairs.shared[:2].tolist() == [[0.0, 0.0], [MEASURED_MM, EDGE_PX]]
    assert len(pairs) > 150
    away = np.hypot(*(np.array(found.places_px) - (159.5, 119.5)).T)
    assert away == pytest.approx(pairs.radii_px[1:])
    assert steps[0] == "looking what stands around the robot of b.png"
    off = pairs.measured_px - PAPER_MIRROR.px_from_mm(pairs.distances_mm)
    assert abs(np.median(off)) < 0.3


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--picture", "onboard-0.png"), "one --at MM or one --around FILE for each --picture"),
        (("--picture", "onboard-0.png", "--at", "500", "--click", "7"), "accepted: X,Y in pixels"),
        (("--picture", "onboard-0.png", "--at", "500", "--center", "a,b"), "accepted: X,Y in pixels"),
        (("--picture", "onboard-0.png", "--at", "500", "--click", "5,5"), "no edge at 53 degrees"),
        (("--picture", "onboard-0.png", "--around", "ceiling-0.png", "--robot", "red:1"), "team and number"),
        ((), "no pairs"),
    ],
)
def test_what_is_refused(taken: tuple[Settings, Path], words: tuple[str, ...], said: str) -> None:
    _, folder = taken
    full = [str(folder / word) if word.endswith(".png") else word for word in words]
    error = CliRunner().invoke(app, ["calibrate", "mirror", *full]).exception
    assert isinstance(error, SettingsError | SourceError)
    assert said in str(error)
