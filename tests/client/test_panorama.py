"""The on-board picture: what stands where, and that a client can draw it with NumPy alone."""

import subprocess
import sys

import numpy as np
import pytest

from vision_core.client.panorama import BALL, COLORS, DARK, FLOOR, FRONT, UNDEFINED_COLOR, draw_panorama
from vision_core.geometry import Bytes
from vision_core.models.mirror import Mirror
from vision_core.types.edges import Rgb

MIRROR = Mirror(4.0187, 0.0125935, 90000.0)
"""Horizon at 108.8 px, one metre at 86.6 px; fits the picture unscaled."""
CENTER = (160, 120)


def at(picture: Bytes, left: int, up: int) -> Rgb:
    """The color so many pixels left of and above the center."""
    red, green, blue = picture[CENTER[1] - up, CENTER[0] - left].tolist()
    return red, green, blue


def is_shade(color: Rgb, of: Rgb) -> bool:
    """The same hue, perhaps darker."""
    share = sum(color) / sum(of)
    return 0.3 < share < 1.02 and all(abs(c - share * o) <= 3 for c, o in zip(color, of, strict=True))


def test_directions_are_where_the_robot_sees_them() -> None:
    # ahead a wall, left blue 1, behind yellow 2, right a goal; each a quarter wide, at 60 px
    letters = "w" * 45 + "A" * 90 + "b" * 90 + "u" * 90 + "w" * 45
    picture = draw_panorama(np.full(360, 60.0), letters, None, MIRROR)
    assert picture.shape == (240, 320, 3)
    assert picture.dtype == np.uint8
    for (left, up), letter in {(0, 80): "w", (80, 0): "A", (0, -80): "b", (-80, 0): "u"}.items():
        assert is_shade(at(picture, left, up), COLORS[letter])
        assert at(picture, left * 5 // 8, up * 5 // 8) == FLOOR  # 50 px: before the edge
    assert at(picture, 0, 0) != FLOOR  # the own body
    assert at(picture, 0, 14) == FRONT  # its front looks up
    assert at(picture, 0, 115) == DARK  # beyond the horizon
    mirrored = draw_panorama(np.full(360, 60.0), letters, None, MIRROR, clockwise=True)
    assert is_shade(at(mirrored, -80, 0), COLORS["A"])


def test_the_ball_is_a_patch_of_its_size_in_its_place() -> None:
    picture = draw_panorama(np.full(360, 100.0), "w" * 360, (60, 90, 20), MIRROR)
    orange = (np.abs(picture.astype(int) - BALL).max(axis=2) < 10).nonzero()
    assert np.mean(CENTER[0] - orange[1]) == pytest.approx(60.5, abs=1.0)
    assert np.mean(CENTER[1] - orange[0]) == pytest.approx(0.0, abs=1.0)
    assert (np.ptp(orange[0]) + 1) / 2 == pytest.approx(60.5 * np.sin(np.radians(10.0)), abs=1.0)


def test_one_edge_is_joined_and_two_are_not() -> None:
    # 20 degrees apart: a wall from 60 to 66 px joined by a line; a wall at 60 and a robot at 66 meet half-way
    radii = np.full(18, 60.0)
    radii[1:] = 66.0
    wall = draw_panorama(radii, "w" * 18, None, MIRROR)
    step = draw_panorama(radii, "w" + "r" * 17, None, MIRROR)
    angle = np.radians(5.0)
    left, up = round(61.0 * np.sin(angle)), round(61.0 * np.cos(angle))  # between 60.5 and 62.0
    assert at(wall, left, up - 1) == FLOOR
    assert at(step, left, up + 1) != FLOOR
    jump = draw_panorama(np.where(np.arange(18) == 0, 40.0, 66.0), "r" * 18, None, MIRROR)
    left, up = round(50.0 * np.sin(angle)), round(50.0 * np.cos(angle))
    assert is_shade(at(jump, left, up), COLORS["r"])  # two robots of one type: no ramp between them


def test_nothing_within_range_is_floor_up_to_the_horizon() -> None:
    picture = draw_panorama(np.full(360, 255.0), "-" * 360, None, MIRROR)
    assert at(picture, 60, 84) == FLOOR
    assert at(picture, 0, 112) == DARK


def test_a_field_of_view_leaves_the_rest_dark() -> None:
    picture = draw_panorama(np.full(90, 60.0), "w" * 90, None, MIRROR, fov_deg=(90.0, 0.0))
    assert at(picture, 0, 50) == FLOOR
    assert at(picture, 0, -50) == DARK
    assert at(picture, 50, 0) == DARK


def test_a_wide_horizon_is_scaled_into_the_picture() -> None:
    wide = Mirror(1.933098, 0.00296946, 360000.0)  # horizon 252.6 px
    picture = draw_panorama(np.full(360, 126.0), "w" * 360, None, wide)
    assert is_shade(at(picture, 70, 0), COLORS["w"])
    assert at(picture, 118, 0) == DARK


def test_letters_are_the_callers_to_color() -> None:
    picture = draw_panorama(np.full(4, 60.0), "Z!Z!", None, MIRROR, colors={"!": (9, 99, 199)})
    assert is_shade(at(picture, 0, 80), UNDEFINED_COLOR)
    assert is_shade(at(picture, 80, 0), (9, 99, 199))


@pytest.mark.parametrize(("count", "letters"), [(3, "ww"), (0, "")])
def test_a_letter_for_every_radius(count: int, letters: str) -> None:
    with pytest.raises(ValueError, match="one letter for each"):
        draw_panorama(np.full(count, 60.0), letters, None, MIRROR)


def test_numpy_alone_is_enough_to_draw() -> None:
    heavy = "{'cv2', 'numba', 'msgspec'} & set(sys.modules)"
    code = f"import sys, vision_core.client.panorama, vision_core.client.png; sys.exit(str({heavy}) if {heavy} else 0)"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
