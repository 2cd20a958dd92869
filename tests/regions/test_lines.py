"""Lines that are painted elsewhere than the field's measures say are noticed."""

import msgspec
import numpy as np
import pytest

from vision_core.capture.source import open_source
from vision_core.clock import ManualClock
from vision_core.geometry import Bytes
from vision_core.regions.lines import line_reasons
from vision_core.settings import Settings
from vision_core.settings_files import load_settings
from vision_core.settings_models import camera_model_from

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def settings() -> Settings:
    return load_settings()


@pytest.fixture(scope="module")
def image(settings: Settings) -> Bytes:
    pixels = np.empty((settings.camera.height_px, settings.camera.width_px, 3), dtype=np.uint8)
    source = open_source(settings, ManualClock(), paced=False)
    source.grab(pixels)
    source.close()
    return pixels


def test_the_right_field_matches(settings: Settings, image: Bytes) -> None:
    assert line_reasons(image, settings.field, camera_model_from(settings)) == ()


def test_another_field_does_not(settings: Settings, image: Bytes) -> None:
    shorter = msgspec.structs.replace(settings.field, length_m=2.2, width_m=1.8)
    (reason,) = line_reasons(image, shorter, camera_model_from(settings))
    assert reason.startswith("only ")
    larger = load_settings(options={"field_preset": "ssl-division-b"}).field
    (reason,) = line_reasons(image, larger, camera_model_from(settings))
    assert "outside of the picture" in reason


def test_a_field_without_lines_is_not_judged(settings: Settings, image: Bytes) -> None:
    plain = msgspec.structs.replace(settings.field, line_width_m=0.0)
    assert line_reasons(image, plain, camera_model_from(settings)) == ()
