"""Other light: what each change does to a picture, and how a venue's score in it is counted."""

from pathlib import Path

import numpy as np
import pytest

from tests.evaluation.test_stills import settings, still  # noqa: F401
from vision_core.capture.faults import changed_light
from vision_core.evaluation.lights import LIGHTS, gained, score_in_lights, warmed
from vision_core.evaluation.truth_files import PictureTruth, TrueRobot
from vision_core.geometry import Bytes
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

GREY = np.full((10, 40, 3), 100, dtype=np.uint8)


def test_every_change_keeps_size_and_type_and_leaves_the_picture_alone() -> None:
    before = GREY.copy()
    for name, change in LIGHTS.items():
        after = change(GREY)
        assert (after.shape, after.dtype) == (GREY.shape, GREY.dtype), name
        assert np.array_equal(before, GREY), name


def test_warm_light_takes_blue_and_cold_light_red() -> None:
    blue, green, red = changed_light(warmed(2700))(GREY)[0, 0].tolist()
    assert blue < green < red == 100
    blue, green, red = changed_light(warmed(7500))(GREY)[0, 0].tolist()
    assert blue > green > red
    assert changed_light(gained((0.5, 1.0, 4.0), 20.0))(GREY)[0, 0].tolist() == [70, 120, 255]


def black(pixels: Bytes) -> Bytes:
    return np.zeros_like(pixels)


@pytest.mark.parametrize(("worn", "right", "wrong"), [(6, 1, 0), (3, 0, 1)])
def test_found_right_and_wrong_are_counted_apart(
    worn: int,
    right: int,
    wrong: int,
    settings: Settings,  # noqa: F811
    still: Path,  # noqa: F811
) -> None:
    truth = PictureTruth(still, (TrueRobot(Team.BLUE, worn, 60.0, 50.0),), frozenset(Team), None, (), None, "one")
    as_it_is, dark = score_in_lights([truth], settings, 15.0, {"as it is": lambda pixels: pixels, "black": black})
    assert as_it_is.row() == {
        "light": "as it is", "pictures": 1, "robots": 1, "found": 1, "ids": 1, "right": right, "wrong": wrong,
        "false": 0,
    }  # fmt: skip
    assert (dark.found, dark.right, dark.wrong, dark.robots) == (0, 0, 0, 1)
