"""A whole field with painted lines, six robots and a ball, drawn through a camera, and venues that describe it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.web.health.sightings import sighting_degradations
from tests.app.fake_snapshot import NOW, serving_snapshot, timed, with_records
from tests.objects.drawing import CODES, SETTINGS, Picture
from vision_core.clock import Instant, ManualClock
from vision_core.errors import PslvError
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel, PinholeCamera
from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.diagnosis import reasons_of
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.venue_warnings import venue_warnings
from vision_core.regions.lines import line_check
from vision_core.regions.shift_words import displaced_reasons
from vision_core.types.image import ImageFrame
from vision_core.types.objects import Diagnosis
from vision_core.types.regions import Finding, LineCheck
from vision_core.venues.loader import layers_of, place_of, settings_from_layers

WIDTH, HEIGHT = 640, 480
FOCAL_PX = 740.0
POSITION_M, ROTATION_DEG = (0.05, -0.05, 4.0), (0.5, -0.6, 0.8)
STRAIGHT = (0.0, 0.0, 0.0, 0.0, 0.0)
CORNERS_M = np.array([(-1.4, 1.15), (1.4, 1.15), (1.4, -1.15), (-1.4, -1.15)])
NAMES = ("left top", "right top", "right bottom", "left bottom")
Robot = tuple[str, int, float, float, float]
ROBOTS: tuple[Robot, ...] = (
    ("blue", 1, -0.8, 0.5, 0.3),
    ("blue", 2, 0.6, 0.7, 2.0),
    ("blue", 3, -0.3, -0.6, -1.0),
    ("yellow", 1, 0.9, -0.4, 1.1),
    ("yellow", 4, 0.1, 0.2, -2.2),
    ("yellow", 5, -1.0, -0.3, 0.0),
)
"""Team, id, x and y [m], heading [rad]."""


def camera(distortion: Sequence[float] = STRAIGHT, focal_px: float = FOCAL_PX) -> CameraModel:
    """The camera that sees the field."""
    return PinholeCamera(focal_px, (WIDTH / 2, HEIGHT / 2), distortion, POSITION_M, ROTATION_DEG)


def drawn(model: CameraModel | None = None, robots: Sequence[Robot] = ROBOTS, *, lines: bool = True) -> Picture:
    """The field in a picture, to be drawn further."""
    picture = Picture(model or camera(), WIDTH, HEIGHT)
    if lines:
        picture.paint_lines(SETTINGS.field)
    for team, number, *pose in robots:
        picture.paint_robot(team, CODES[number], *pose)
    picture.paint_ball(0.45, -0.75)
    return picture


def points_venue(
    pixels: Floats | None = None,
    places: Floats = CORNERS_M,
    position_m: Sequence[float] = POSITION_M,
    preset: str = "ssl-2002",
    names: Sequence[str] = NAMES,
) -> str:
    """A venue of a camera from the four corners."""
    seen = camera().pixel_from_field(CORNERS_M) if pixels is None else pixels
    rows = [
        f'  {{ name = "{name}", pixel_px = {pixel}, field_m = {place} }},'
        for name, pixel, place in zip(names, np.round(seen, 2).tolist(), places.tolist(), strict=True)
    ]
    named = ["[camera.homography]", f"position_m = {list(position_m)}", "points = [", *rows, "]"]
    return "\n".join([f'field_preset = "{preset}"', "[camera]", 'model = "homography"', *named, ""])


def lens_venue(
    position_m: Sequence[float] = POSITION_M,
    rotation_deg: Sequence[float] = ROTATION_DEG,
    distortion: Sequence[float] = STRAIGHT,
    preset: str = "ssl-2002",
    focal_px: float = FOCAL_PX,
) -> str:
    """A venue of a camera with a lens."""
    lens = [
        "[camera.pinhole]",
        f"focal_px = {focal_px}",
        f"center_px = [{WIDTH / 2}, {HEIGHT / 2}]",
        *(
            f"{key} = {[float(value) for value in values]}"
            for key, values in (
                ("distortion", distortion),
                ("position_m", position_m),
                ("rotation_deg", rotation_deg),
            )
        ),
    ]
    return "\n".join([f'field_preset = "{preset}"', "[camera]", 'model = "pinhole"', *lens, ""])


@dataclass(frozen=True)
class Told:
    """What is said about a venue and a picture."""

    validate: str
    """The refusal, or the warnings."""
    is_refused: bool
    robots: str = ""
    """What detect finds: "b1 y4 y?"."""
    detect: tuple[str, ...] = ()
    """Its reasons, in their order."""
    service: tuple[str, ...] = ()
    """The causes that /readyz and the page give."""


def told(folder: Path, venue: str, pixels: Bytes) -> Told:
    """What ``pslv config validate``, ``pslv detect``, /readyz and the page say."""
    file = folder / "venue.toml"
    file.write_text(venue)
    try:
        layers = layers_of(str(file))
        settings = settings_from_layers(layers)
        warnings = "; ".join(venue_warnings(settings, lambda key: place_of(key, layers)))
    except PslvError as error:
        return Told(str(error), True)
    setup = CameraSetup.from_settings(settings)
    perception = Perception(settings, setup)
    seen = perception.perceive(ImageFrame("main", 1, Instant(0), pixels), ManualClock()).record()
    robots = " ".join(f"{robot.team[0]}{'?' if robot.id is None else robot.id}" for robot in seen.robots)
    reasons = reasons_of(perception, seen)
    check = line_check(pixels, settings.field, setup.model)
    lines = LineCheck(
        check.known, check.found, check.samples, check.residual_px, check.outside,
        displaced_reasons(pixels, settings.field, setup),
    )  # fmt: skip
    snapshot = with_records(
        serving_snapshot(),
        sightings=timed(seen),
        lines=timed(Finding("main", 1, NOW, lines)),
        diagnosis=timed(Diagnosis("main", 1, NOW, reasons)),
    )
    service = tuple(cause.sentence for cause in sighting_degradations(snapshot))
    return Told(warnings, False, robots, tuple(map(str, reasons)), service)
