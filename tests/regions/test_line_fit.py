"""A wrong calibration shows by where the painted lines lie, and is said with its direction and size."""

import re
from itertools import pairwise
from typing import Any

import msgspec
import numpy as np
import pytest

from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import Instant, ManualClock
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import painted_points
from vision_core.native.opencv import draw_line
from vision_core.regions.line_fit import line_shifts
from vision_core.regions.shift_words import calibration_reasons, displaced_reasons
from vision_core.settings.schema import FieldSettings, HomographySettings, NamedPoint, PinholeSettings
from vision_core.venues.loader import load_settings
from vision_core.venues.presets import shipped_fields

SETTINGS = load_settings()
FIELD = SETTINGS.field
PLACES = np.array([(-1.4, 1.15), (1.4, 1.15), (1.4, -1.15), (-1.4, -1.15)])
PIXELS = np.array([(40.0, 10.0), (600.0, 14.0), (590.0, 465.0), (45.0, 470.0)])
NAMES = ("left top", "right top", "right bottom", "left bottom")
SIDES = {(15.0, 0.0): "to the right of", (-15.0, 0.0): "to the left of", (0.0, 15.0): "below", (0.0, -15.0): "above"}
LENS = PinholeSettings(
    focal_px=740.0,
    center_px=(320.0, 240.0),
    distortion=(0.0, 0.0, 0.0, 0.0, 0.0),
    position_m=(0.05, -0.05, 4.0),
    rotation_deg=(0.5, -0.6, 0.8),
)


def camera(pixels: Floats = PIXELS) -> CameraSetup:
    """A camera from four named points."""
    points = tuple(
        NamedPoint(name=name, pixel_px=tuple(pixel), field_m=tuple(place))
        for name, pixel, place in zip(NAMES, pixels.tolist(), PLACES.tolist(), strict=True)
    )
    named = HomographySettings(points=points, position_m=(0.0, 0.0, 4.0))
    return CameraSetup(msgspec.structs.replace(SETTINGS.camera, model="homography", homography=named))


def pinhole(**changes: Any) -> CameraSetup:
    """A camera with a lens."""
    return CameraSetup(msgspec.structs.replace(SETTINGS.camera, pinhole=msgspec.structs.replace(LENS, **changes)))


def drawn(thickness_px: int, setup: CameraSetup | None = None, field: FieldSettings = FIELD) -> Bytes:
    image = np.full((480, 640, 3), (60, 110, 60), dtype=np.uint8)
    model = (setup or camera()).model
    for points in painted_points(field, 40):
        for start, end in pairwise(model.pixel_from_field(points).tolist()):
            draw_line(image, start, end, (220, 220, 220), thickness_px)
    return image


def test_lines_in_their_places_are_in_order() -> None:
    shifts = line_shifts(drawn(4), FIELD, camera().model)
    assert shifts is not None
    assert np.abs(shifts.shifts_px).max() < 1.0
    assert (shifts.bow_px, calibration_reasons(drawn(4), FIELD, camera())) == (0.0, ())


def test_the_demo_s_walls_beside_its_lines_raise_no_alarm() -> None:
    settings = load_settings()
    setup = CameraSetup.from_settings(settings)
    source = SyntheticCamera(settings, setup, ManualClock(Instant(100)), paced=False)
    pixels = setup.black_image()
    for _ in range(40):
        for _ in range(12):
            source.grab(pixels)
        assert displaced_reasons(pixels, settings.field, setup) == ()


@pytest.mark.parametrize("thickness_px", [1, 4])
@pytest.mark.parametrize("corner", range(4))
@pytest.mark.parametrize("shift_px", SIDES)
def test_a_point_15_px_off_is_reported_at_its_corner(
    thickness_px: int, corner: int, shift_px: tuple[float, float]
) -> None:
    pixels = PIXELS.copy()
    pixels[corner] += shift_px
    field = msgspec.structs.replace(FIELD, line_width_m=FIELD.line_width_m if thickness_px > 1 else 0.004)
    (reason,) = displaced_reasons(drawn(thickness_px), field, camera(pixels))
    words = re.fullmatch(r"'(.+)' lies (\d+) px \((\d) cm\) (.+) where the lines say: robots there .*", reason.text)
    assert words is not None, reason.text
    assert words[1] == NAMES[corner]
    assert abs(int(words[2]) - 15) <= 2
    assert abs(int(words[3]) - 7.5) <= 1.5
    assert words[4] == SIDES[shift_px]
    x, y = PIXELS[corner]
    told = re.search(r"is at \((\d+), (\d+)\) px", reason.text)
    assert told is not None
    assert np.hypot(float(told[1]) - x, float(told[2]) - y) < 4.0
    assert reason.is_calibration


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"position_m": (0.05, -0.05, 4.4)}, r"the field (9|10)% too small.*a camera (3.9\d|4.0\d) m high, not 4.40 m"),
        ({"position_m": (0.05, -0.05, 3.6)}, r"the field 1[012]% too large.*a camera (3.9\d|4.0\d) m high, not 3.60 m"),
        ({"rotation_deg": (0.5, -0.6, 2.8)}, r"the field turned clockwise by (1.9|2.[01]) deg"),
        ({"rotation_deg": (0.5, -0.6, -1.2)}, r"the field turned anticlockwise by (1.9|2.[01]) deg"),
        ({"position_m": (0.15, -0.05, 4.0)}, r"the field 1[89] px \(10 cm\) too far left, .* placed 10 cm off"),
        ({"position_m": (0.05, 0.05, 4.0)}, r"the field 1[89] px \(10 cm\) too far down"),
    ],
)
def test_what_moves_all_corners_alike_is_said_as_one(changes: dict[str, Any], words: str) -> None:
    (reason,) = calibration_reasons(drawn(2, pinhole()), FIELD, pinhole(**changes))
    assert re.search(words, reason.text), reason.text


def test_a_lens_that_bends_lines_is_told_from_points_that_are_off() -> None:
    bent = pinhole(distortion=(-0.5, 0.2, 0.0, 0.0, 0.0), focal_px=800.0)
    image = drawn(2, bent)
    (reason,) = calibration_reasons(image, FIELD, camera(bent.model.pixel_from_field(PLACES)))
    assert re.search(r"the lens bends lines, .* up to 1\d px \([78] cm\) between them", reason.text), reason.text
    assert calibration_reasons(image, FIELD, bent) == ()
    straight = pinhole(focal_px=800.0)
    assert any("other than the venue's distortion" in said.text for said in calibration_reasons(image, FIELD, straight))


@pytest.mark.parametrize("preset", ["ssl-division-b", "vsss", "mirosot-middle"])
def test_the_lines_of_another_preset_are_named(preset: str) -> None:
    (reason,) = calibration_reasons(drawn(2, pinhole()), shipped_fields()[preset], pinhole())
    assert "12 of 12 painted lines are where field_preset = 'ssl-2002' has them" in reason.text
    assert reason.advice.startswith("Set field_preset = 'ssl-2002'")


def test_without_lines_nothing_is_said() -> None:
    image = np.full((480, 640, 3), 90, dtype=np.uint8)
    assert line_shifts(image, FIELD, camera().model) is None
    plain = msgspec.structs.replace(FIELD, line_width_m=0.0)
    assert displaced_reasons(drawn(4), plain, camera()) == ()
