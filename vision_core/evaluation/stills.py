"""Pictures from files, each judged alone: what ``pslv detect`` prints."""

from collections.abc import Iterable, Iterator
from pathlib import Path

import msgspec

from vision_core.clock import Instant, MonotonicClock
from vision_core.color.pictures import axis_pictures
from vision_core.errors import PslvError, SourceError
from vision_core.evaluation.overlay import draw_classes, draw_sightings
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import read_picture, write_picture
from vision_core.pipeline.diagnosis import reasons_of
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import Settings
from vision_core.tasks.obstacles import finder_from
from vision_core.types.image import ImageFrame
from vision_core.types.reasons import Reason


def detect_files(files: Iterable[Path], settings: Settings, draw: Path | None) -> Iterator[dict[str, object]]:
    """For every picture one table that JSON can hold: ``{"file", "robots", "balls", "obstacles", "reasons"}``.

    A picture that cannot be read or has not the camera's size gives ``{"file", "error"}``, and the rest
    go on. draw: folder for overlays, made when it is not there: NAME.png shows what was
    found and where the field's lines are thought, NAME-classes.png the color class of every pixel, and two
    more the color space's hue and how colored each pixel is.
    Raises SettingsError when the settings name no usable pattern, SourceError when the folder cannot be made.
    """
    perception = Perception(settings, CameraSetup.from_settings(settings))
    if draw is not None:
        make_folder(draw)
    for file in files:
        try:
            yield detect_still(file, perception, draw)
        except PslvError as error:
            yield {"file": str(file), "error": str(error)}


def calibration_reasons_in(file: Path, settings: Settings) -> tuple[Reason, ...]:
    """What the painted lines and the robots in a picture say against the venue's calibration; () for nothing.

    Raises SourceError when it cannot be read or has another size, SettingsError when the settings name no usable
    pattern.
    """
    perception = Perception(settings, CameraSetup.from_settings(settings))
    camera = perception.camera
    frame = ImageFrame(camera.name, 1, Instant(0), read_picture(file, camera.size_px))
    seen = perception.perceive_still(frame, MonotonicClock()).record()
    return tuple(reason for reason in reasons_of(perception, seen) if reason.is_calibration)


def detect_still(file: Path, perception: Perception, draw: Path | None = None) -> dict[str, object]:
    """The table of one picture. Raises SourceError when it cannot be read, has another size, or the overlay fails."""
    settings = perception.settings
    camera = perception.camera
    pixels = read_picture(file, camera.size_px)
    seen = perception.perceive_still(ImageFrame(camera.name, 1, Instant(0), pixels), MonotonicClock()).record()
    obstacles = finder_from(settings, camera).find(pixels, seen.robots, seen.balls)
    if draw is not None:
        overlay = draw_sightings(pixels, seen, camera.model, settings, obstacles)
        write_picture(draw / f"{file.stem}.png", overlay)
        lit = perception.pixels
        write_picture(draw / f"{file.stem}-classes.png", draw_classes(lit, perception.table))
        for axis, picture in axis_pictures(lit, settings.colors.space).items():
            write_picture(draw / f"{file.stem}-{axis}.png", picture)
    parts = {
        "file": str(file),
        "robots": list(seen.robots),
        "balls": list(seen.balls),
        "obstacles": list(obstacles),
        "reasons": [str(reason) for reason in reasons_of(perception, seen)],
    }
    table: dict[str, object] = msgspec.to_builtins(parts)
    return table


def make_folder(folder: Path) -> None:
    """Make a folder for overlays, unless it is there. Raises SourceError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        found = error.strerror or str(error)
        raise SourceError(
            f"folder {folder} for overlays", found=found, accepted="a folder that may be written"
        ) from None
