"""Tries a venue on its pictures: what is seen with it, and with the settings in use beside it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from vision_core.calibration.result import Progress
from vision_core.errors import PslvError
from vision_core.evaluation.stills import detect_still, make_folder
from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import Settings
from vision_core.setup.findings import PictureTrial, SeenRobot, VenueTrial


def try_venue(
    files: Sequence[Path], settings: Settings, in_use: Settings | None, folder: Path, progress: Progress
) -> VenueTrial:
    """Judge pictures with a venue's settings, and with those in use; overlays go into a folder.

    Raises SettingsError for settings that perception refuses, SourceError when the folder cannot be made, and what
    progress raises.
    """
    make_folder(folder)
    why_not = _why_not(settings, in_use)
    compared = [settings, *([in_use] if in_use is not None and not why_not else [])]
    trials: list[tuple[PictureTrial, ...]] = []
    for number, one in enumerate(compared):
        progress("preparing the search", number / len(compared))
        perception = Perception(one, CameraSetup.from_settings(one))
        found = []
        for index, file in enumerate(files):
            words = "with the settings in use: " if number else ""
            share = (number + index / len(files)) / len(compared)
            progress(f"{words}picture {index + 1} of {len(files)}", share)
            found.append(_tried(file, perception, folder if number == 0 else None))
        trials.append(tuple(found))
    progress("done", 1.0)
    return VenueTrial(trials[0], trials[1] if len(trials) > 1 else (), why_not)


def _tried(file: Path, perception: Perception, folder: Path | None) -> PictureTrial:
    try:
        found: dict[str, Any] = detect_still(file, perception, folder)
    except PslvError as error:
        return PictureTrial((), 0, 0, (), "", str(error))
    robots = tuple(
        SeenRobot(robot["team"], robot["id"], robot["x_m"], robot["y_m"], robot["confidence"])
        for robot in found["robots"]
    )
    overlay = f"{file.stem}.png" if folder is not None else ""
    return PictureTrial(robots, len(found["balls"]), len(found["obstacles"]), tuple(found["reasons"]), overlay, "")


def _why_not(settings: Settings, in_use: Settings | None) -> str:
    if in_use is None:
        return "no settings are in use"
    mine, theirs = ((one.camera.width_px, one.camera.height_px) for one in (settings, in_use))
    if mine == theirs:
        return ""
    return f"the settings in use are for pictures of {theirs[0]}x{theirs[1]}, these are of {mine[0]}x{mine[1]}"
