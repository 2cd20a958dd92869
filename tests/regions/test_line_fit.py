"""One named point that is off shows as one corner of the field at which the painted lines lie beside their places."""

from itertools import pairwise

import msgspec
import numpy as np
import pytest

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import HomographyCamera
from vision_core.models.field import painted_points
from vision_core.native.opencv import draw_line
from vision_core.regions.line_fit import corner_shifts, shift_reasons
from vision_core.venues.loader import load_settings

FIELD = load_settings().field
PLACES = np.array([(-1.4, 1.15), (1.4, 1.15), (1.4, -1.15), (-1.4, -1.15)])
PIXELS = np.array([(40.0, 10.0), (600.0, 14.0), (590.0, 465.0), (45.0, 470.0)])
NAMES = ("left top", "right top", "right bottom", "left bottom")


def camera(pixels: Floats = PIXELS) -> HomographyCamera:
    return HomographyCamera(pixels, PLACES, (0.0, 0.0, 4.0))


def drawn(thickness_px: int) -> Bytes:
    image = np.full((480, 640, 3), (60, 110, 60), dtype=np.uint8)
    for points in painted_points(FIELD, 40):
        for start, end in pairwise(camera().pixel_from_field(points).tolist()):
            draw_line(image, start, end, (220, 220, 220), thickness_px)
    return image


def test_lines_in_their_places_are_in_order() -> None:
    image = drawn(4)
    assert max(corner_shifts(image, FIELD, camera()).values()) < 1.0
    assert shift_reasons(image, FIELD, camera()) == ()


@pytest.mark.parametrize("thickness_px", [1, 4])
@pytest.mark.parametrize("corner", range(4))
@pytest.mark.parametrize("shift_px", [(15.0, 0.0), (0.0, 15.0), (-15.0, 0.0), (0.0, -15.0)])
def test_a_point_15_px_off_is_reported_at_its_corner(
    thickness_px: int, corner: int, shift_px: tuple[float, float]
) -> None:
    pixels = PIXELS.copy()
    pixels[corner] += shift_px
    field = msgspec.structs.replace(FIELD, line_width_m=FIELD.line_width_m if thickness_px > 1 else 0.004)
    (reason,) = shift_reasons(drawn(thickness_px), field, camera(pixels))
    assert f"most at the field's {NAMES[corner]} corner" in reason.text


def test_without_lines_nothing_is_said() -> None:
    image = np.full((480, 640, 3), 90, dtype=np.uint8)
    assert corner_shifts(image, FIELD, camera()) == {}
    plain = msgspec.structs.replace(FIELD, line_width_m=0.0)
    assert shift_reasons(drawn(4), plain, camera()) == ()
