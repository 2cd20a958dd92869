"""Lines that are painted elsewhere than the field's measures say are noticed."""

import msgspec
import numpy as np
import pytest

from vision_core.capture.source import open_source
from vision_core.clock import ManualClock
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.models.camera import PinholeCamera
from vision_core.models.camera_setup import CameraSetup
from vision_core.regions.lines import line_check, line_reasons
from vision_core.settings.schema import Settings
from vision_core.types.regions import LineCheck
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def settings() -> Settings:
    return load_settings()


@pytest.fixture(scope="module")
def image(settings: Settings) -> Bytes:
    pixels = CameraSetup.from_settings(settings).black_image()
    source = open_source(settings, CameraSetup.from_settings(settings), ManualClock(), paced=False)
    source.grab(pixels)
    source.close()
    return pixels


def test_the_right_field_matches(settings: Settings, image: Bytes) -> None:
    assert line_reasons(image, settings.field, CameraSetup.from_settings(settings).model) == ()


def test_another_field_does_not(settings: Settings, image: Bytes) -> None:
    shorter = msgspec.structs.replace(settings.field, length_m=2.2, width_m=1.8)
    (reason,) = line_reasons(image, shorter, CameraSetup.from_settings(settings).model)
    assert reason.text.startswith("only ")
    larger = load_settings(options={"field_preset": "ssl-division-b"}).field
    (reason,) = line_reasons(image, larger, CameraSetup.from_settings(settings).model)
    assert "outside of the picture" in reason.text


def test_a_field_without_lines_is_not_judged(settings: Settings, image: Bytes) -> None:
    plain = msgspec.structs.replace(settings.field, line_width_m=0.0)
    assert line_reasons(image, plain, CameraSetup.from_settings(settings).model) == ()


def test_numbers_of_the_right_field(settings: Settings, image: Bytes) -> None:
    check = line_check(image, settings.field, CameraSetup.from_settings(settings).model)
    assert check.known == 12
    assert check.found >= 6
    assert check.samples is not None
    assert check.samples > 0.5
    assert check.residual_px is not None
    assert check.residual_px < 0.25
    assert check.outside < 0.01


@pytest.mark.parametrize("turn_px", [0.5, 1.0, 2.0])
def test_a_camera_that_was_bumped_shows_in_the_residual(settings: Settings, image: Bytes, turn_px: float) -> None:
    right = CameraSetup.from_settings(settings).model
    pinhole = settings.camera.pinhole
    center = (pinhole.center_px[0] + turn_px, pinhole.center_px[1] + turn_px)
    moved = PinholeCamera(pinhole.focal_px, center, pinhole.distortion, pinhole.position_m, pinhole.rotation_deg)
    residuals = [line_check(image, settings.field, camera).residual_px for camera in (right, moved)]
    assert residuals[0] is not None
    assert residuals[1] is not None
    assert residuals[1] == pytest.approx(turn_px, abs=0.25)
    assert line_reasons(image, settings.field, moved) == ()


def test_numbers_where_nothing_can_be_judged(settings: Settings, image: Bytes) -> None:
    plain = msgspec.structs.replace(settings.field, line_width_m=0.0)
    assert line_check(image, plain, CameraSetup.from_settings(settings).model) == LineCheck(0, 0, None, None, 0.0)
    thin = msgspec.structs.replace(settings.field, line_width_m=0.002)
    assert line_check(image, thin, CameraSetup.from_settings(settings).model).known == 0
    nothing = line_check(np.full_like(image, 90), settings.field, CameraSetup.from_settings(settings).model)
    assert (nothing.found, nothing.samples, nothing.residual_px) == (0, 0.0, None)


def test_a_camera_that_makes_lines_wider_than_the_picture_is_refused(settings: Settings, image: Bytes) -> None:
    """Two swapped calibration points made numpy ask for 385 TiB."""
    pinhole = settings.camera.pinhole
    wrong = PinholeCamera(1e12, pinhole.center_px, pinhole.distortion, pinhole.position_m, pinhole.rotation_deg)
    with pytest.raises(SettingsError, match="painted lines in the picture"):
        line_check(image, settings.field, wrong)
