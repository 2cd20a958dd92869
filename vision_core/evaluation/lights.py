"""How well a venue holds in other light than the one of its pictures: what ``pslv evaluate --lights`` prints.

Every picture is changed as another light, another setting of the camera or a poor connection would change it
(``capture.faults``), and scored against the same truth. Each change happens alone: a stage that is right in all of
these is not right by a lucky curve.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import msgspec

from vision_core.capture.faults import NO_LIGHT_FAULT, Change, changed_light
from vision_core.clock import Instant, ManualClock
from vision_core.evaluation.score import score_picture
from vision_core.evaluation.truth_files import PictureTruth
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import read_picture
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import LightFaultSettings, Settings
from vision_core.types.image import ImageFrame

Gains = tuple[float, float, float]
"""Of blue, green and red."""

BLACKBODY_BGR = {
    2700: (0.34, 0.66, 1.0),
    3500: (0.55, 0.77, 1.0),
    4500: (0.76, 0.88, 1.0),
    5500: (0.93, 0.95, 1.0),
    6500: (1.0, 0.98, 0.99),
    7500: (1.0, 0.93, 0.88),
}
"""Blue, green and red of a black body by its temperature [K], the largest being 1 (T. Tanner's table, as light)."""
TUNED_K = 5500
"""Temperature of the light that a picture is taken to be in."""


@dataclass(slots=True)
class LightScore:
    """Sums over the pictures of a truth file in one light."""

    light: str
    pictures: int = 0
    robots: int = 0
    """True ones."""
    found: int = 0
    """Of the right team and at the right place, with an id or without."""
    ids: int = 0
    """True robots whose id the truth gives."""
    right: int = 0
    wrong: int = 0
    false: int = 0
    """Robots found where none is."""

    def row(self) -> dict[str, Any]:
        """``{"light", "pictures", "robots", "found", "ids", "right", "wrong", "false"}``."""
        row: dict[str, Any] = msgspec.to_builtins(self)
        return row


def score_in_lights(
    truth: Sequence[PictureTruth], settings: Settings, tolerance_px: float, changes: Mapping[str, Change] | None = None
) -> Iterator[LightScore]:
    """The score in every light, as it is done. changes: by name; None: ``LIGHTS``.

    Raises SourceError for a picture that cannot be read, SettingsError for a pattern that cannot.
    """
    perception = Perception(settings, CameraSetup.from_settings(settings))
    pictures = [read_picture(picture.file, perception.camera.size_px) for picture in truth]
    for name, change in (LIGHTS if changes is None else changes).items():
        score = LightScore(name)
        for picture, pixels in zip(truth, pictures, strict=True):
            add_picture(score, picture, _found_in(change(pixels), perception), tolerance_px)
        yield score


def _found_in(pixels: Bytes, perception: Perception) -> dict[str, Any]:
    frame = ImageFrame(perception.camera.name, 1, Instant(0), pixels)
    seen = perception.perceive_still(frame, ManualClock()).record()
    found: dict[str, Any] = msgspec.to_builtins(
        {"robots": list(seen.robots), "balls": list(seen.balls), "reasons": []}
    )  # fmt: skip
    return found


def add_picture(score: LightScore, truth: PictureTruth, found: dict[str, Any], tolerance_px: float) -> None:
    """Count what was found in a picture, a table of ``detect_files``."""
    places = replace(truth, robots=tuple(replace(robot, id=None) for robot in truth.robots))
    named = replace(truth, robots=tuple(robot for robot in truth.robots if robot.id is not None))
    at_places, by_id = (score_picture(one, found, tolerance_px) for one in (places, named))
    score.pictures += 1
    score.robots += at_places.robots.true
    score.found += at_places.robots.hits
    score.false += at_places.robots.found - at_places.robots.hits
    score.ids += by_id.robots.true
    score.right += by_id.robots.hits
    score.wrong += by_id.wrong_ids


def gained(gains_bgr: Gains, black: float = 0.0) -> LightFaultSettings:
    """Every channel times its gain, plus a level of black."""
    return msgspec.structs.replace(NO_LIGHT_FAULT, gain_bgr=gains_bgr, black=black)


def warmed(kelvin: int) -> LightFaultSettings:
    """The light of a black body instead of that of TUNED_K, as bright in its brightest channel."""
    ratios = [new / old for new, old in zip(BLACKBODY_BGR[kelvin], BLACKBODY_BGR[TUNED_K], strict=True)]
    blue, green, red = (ratio / max(ratios) for ratio in ratios)
    return gained((blue, green, red))


LIGHT_FAULTS: dict[str, LightFaultSettings] = {
    "as it is": NO_LIGHT_FAULT,
    **{f"all x {gain:g}": gained((gain,) * 3) for gain in (0.4, 0.7, 1.4, 2.0)},
    **{f"blue x {gain:g}": gained((gain, 1.0, 1.0)) for gain in (0.6, 1.5)},
    **{f"red x {gain:g}": gained((1.0, 1.0, gain)) for gain in (0.6, 1.5)},
    **{f"{kelvin} K": warmed(kelvin) for kelvin in (2700, 3500, 4500, 7500)},
    "right half x 0.5": msgspec.structs.replace(NO_LIGHT_FAULT, right_half=0.5),
    **{f"gamma {gamma:g}": msgspec.structs.replace(NO_LIGHT_FAULT, gamma=gamma) for gamma in (0.7, 1.4)},
    "black + 20": gained((1.0, 1.0, 1.0), 20.0),
    "JPEG 30": msgspec.structs.replace(NO_LIGHT_FAULT, jpeg_quality=30),
    "noise 8": msgspec.structs.replace(NO_LIGHT_FAULT, noise=8.0),
}
"""The changes of light by name, as faults of a source."""
LIGHTS: dict[str, Change] = {name: changed_light(fault) for name, fault in LIGHT_FAULTS.items()}
"""The same as functions of pictures."""
