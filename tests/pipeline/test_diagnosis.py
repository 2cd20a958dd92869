"""Venues with one mistake each: a reason names the mistake. And the time that the search may take."""

from typing import Any

import msgspec
import numpy as np
import pytest

from vision_core.capture.source import open_source
from vision_core.clock import Clock, Instant, ManualClock
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import shrink
from vision_core.pipeline.diagnosis import CUT_SHORT, reasons_of
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import Settings
from vision_core.types.image import ImageFrame
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow

SETTINGS = load_settings()
CLASSES: dict[str, Any] = {
    "orange": [{"hue_deg": [4.0, 34.0], "saturation": [0.55, 1.0], "value": [0.25, 1.0]}],
    "yellow": [{"hue_deg": [42.0, 68.0], "saturation": [0.45, 1.0], "value": [0.36, 1.0]}],
    "blue": [{"hue_deg": [195.0, 240.0], "saturation": [0.50, 1.0], "value": [0.22, 1.0]}],
    "pink": [{"hue_deg": [300.0, 350.0], "saturation": [0.30, 1.0], "value": [0.36, 1.0]}],
    "green": [{"hue_deg": [95.0, 165.0], "saturation": [0.40, 1.0], "value": [0.56, 1.0]}],
}


@pytest.fixture(scope="module")
def image() -> Bytes:
    """A picture of a match in which ball and robots are seen."""
    pixels = np.empty((SETTINGS.camera.height_px, SETTINGS.camera.width_px, 3), dtype=np.uint8)
    source = open_source(SETTINGS, CameraSetup.from_settings(SETTINGS), ManualClock(), paced=False)
    for _ in range(10):
        source.grab(pixels)
    source.close()
    return pixels


class TickingClock:
    """A clock that is one nanosecond later at each reading: as if every step of the search took so long."""

    def __init__(self) -> None:
        self.readings = 0

    def now(self) -> Instant:
        self.readings += 1
        return Instant(self.readings)


def said(
    image: Bytes, settings: Settings = SETTINGS, *, deadline: Instant | None = None, clock: Clock | None = None
) -> tuple[str, ...]:
    """Texts of the reasons."""
    perception = Perception(settings, CameraSetup.from_settings(settings))
    seen = perception.perceive(ImageFrame("main", 1, Instant(0), image), ManualClock()).record()
    return tuple(reason.text for reason in reasons_of(perception, seen, deadline=deadline, clock=clock))


def changed(**options: Any) -> Settings:
    return load_settings(options={key.replace("__", "."): value for key, value in options.items()})


def test_nothing_is_said_about_a_good_picture(image: Bytes) -> None:
    assert said(image) == ()


BROKEN_VENUES: dict[str, tuple[dict[str, Any], str]] = {
    "camera 30 % too low": ({"camera__pinhole__position_m": [0.06, -0.04, 2.6]}, "camera height"),
    "camera 40 % too high": ({"camera__pinhole__position_m": [0.06, -0.04, 5.4]}, "camera height"),
    "another field": ({"field_preset": "ssl-division-b"}, "field 'ssl-division-b'"),
    "a field a little too small": ({"field__length_m": 2.3, "field__width_m": 1.9}, "painted lines"),
    "yellow and pink swapped": (
        {"colors__classes": CLASSES | {"yellow": CLASSES["pink"], "pink": CLASSES["yellow"]}},
        "yellow",
    ),
    "a class that claims others' colors": (
        {"colors__classes": {"orange": [{"value": [0.3, 1.0]}]} | {k: v for k, v in CLASSES.items() if k != "orange"}},
        "claim",
    ),
    "markers of another league": (
        {"robots__pattern": "mirosot-tile", "colors__classes": CLASSES | {"pale": []}},
        "ssl-standard",
    ),
    "a ball three times too large": ({"ball__radius_m": 0.065}, "ball"),
    "dots must be larger than they are": ({"robots__min_area": 1.6}, "area"),
}


@pytest.mark.parametrize(("options", "named"), BROKEN_VENUES.values(), ids=list(BROKEN_VENUES))
def test_a_broken_venue_is_named(image: Bytes, options: dict[str, Any], named: str) -> None:
    reasons = said(image, changed(**options))
    print(*reasons, sep="\n")
    assert any(named in reason for reason in reasons), reasons


def test_a_camera_that_looks_elsewhere_is_named(image: Bytes) -> None:
    """Settings files with such a camera are refused; the reason stands for what rules cannot foresee."""
    lens = msgspec.structs.replace(SETTINGS.camera.pinhole, position_m=(6.0, 0.0, 3.75))
    camera = msgspec.structs.replace(SETTINGS.camera, pinhole=lens)
    reasons = said(image, msgspec.structs.replace(SETTINGS, camera=camera))
    assert any("no part of the field" in reason for reason in reasons), reasons


def test_bad_pictures_are_named(image: Bytes) -> None:
    black = np.random.default_rng(1).integers(0, 8, image.shape, dtype=np.uint8)
    (reason,) = said(black)
    assert "black" in reason
    (reason,) = said((image * 0.25).astype(np.uint8))
    assert "too dark" in reason
    (reason,) = said(np.clip(image.astype(np.int64) * 4, 0, 255).astype(np.uint8))
    assert "over-exposed" in reason
    coarse = shrink(image, SETTINGS.camera.width_px // 16)
    blurred = np.repeat(np.repeat(coarse, 16, axis=0), 16, axis=1)
    assert any("robot" in reason for reason in said(blurred))


def test_what_is_found_by_the_deadline_is_said(image: Bytes) -> None:
    """Another league's markers: the reasons of the own pattern take six steps, those of other patterns come after."""
    venue = changed(robots__pattern="mirosot-tile", colors__classes=CLASSES | {"pale": []})
    whole = said(image, venue)
    assert any("ssl-standard" in reason for reason in whole)
    assert CUT_SHORT.text not in whole
    clock = TickingClock()
    *found, last = said(image, venue, deadline=Instant(7), clock=clock)
    assert found == [reason for reason in whole if "ssl-standard" not in reason]
    assert found
    assert last == CUT_SHORT.text
    assert clock.readings == 7
    assert said(image, venue, deadline=Instant(1), clock=TickingClock()) == (CUT_SHORT.text,)
    assert said(image, venue, deadline=Instant(10_000), clock=TickingClock()) == whole
