"""The reasons given when robots are not found or have no id."""

import numpy as np
import pytest

from tests.objects.drawing import Picture
from tests.objects.finding import empty_picture, middle, scene_of, settings_of
from vision_core.objects.robots.reasons import explain_robots
from vision_core.patterns.loader import load_pattern
from vision_core.types.tables import ROBOT

SSL = load_pattern("ssl-standard")
CODES = SSL.code_by_id


def picture(robots: float = 1.5) -> tuple[Picture, float, float]:
    drawn = empty_picture(SSL, robots, 36.0)
    return drawn, *middle(drawn, SSL.robot.height_m)


def said(drawn: Picture, pattern: str = "ssl-standard", min_confidence: float = 0.3) -> str:
    return "\n".join(map(str, explain_robots(scene_of(drawn), settings_of(pattern, min_confidence=min_confidence))))


def test_no_reason_when_every_robot_has_an_id() -> None:
    drawn, x, y = picture(2.6)
    drawn.paint_robot("blue", CODES[3], x - 0.1, y, 0.3)
    drawn.paint_robot("yellow", CODES[3], x + 0.1, y, 0.3)
    assert said(drawn) == ""


def test_no_blob_of_a_teams_color() -> None:
    text = said(picture()[0])
    assert "no blue robot: no blob of color class blue" in text
    assert "no yellow robot: no blob of color class yellow" in text


def test_wrong_size_is_said_with_its_share() -> None:
    drawn, x, y = picture()
    drawn.paint_disc("blue", x, y, 0.075, SSL.robot.height_m)
    text = said(drawn)
    assert "none of the right size" in text
    assert "has 8.8 times the expected area (accepted: 0.3 to 2)" in text


def test_a_center_without_patches_round_it() -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", "----", x, y, 0.0)
    assert "without another patch of pattern ssl-standard near" in said(drawn)


def test_too_little_confidence() -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", CODES[0], x, y, 0.0)
    assert "below robots.min_confidence = 0.99: 5 of the 5 patches of pattern ssl-standard are found" in said(
        drawn, min_confidence=0.99
    )


@pytest.mark.parametrize(
    ("paint", "expected"),
    [("", "is missing: there is nothing pink or green"), ("orange", "is orange, not pink or green")],
)
def test_what_is_in_a_missing_patchs_place(paint: str, expected: str) -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", "P-PP", x, y, 0.0)
    if paint:
        drawn.paint_disc(paint, x - 0.0548, y + 0.035, 0.02, SSL.robot.height_m)
    text = said(drawn)
    assert "has no id: 4 of the 5 patches of pattern ssl-standard are found" in text
    assert f"the back left patch {expected}" in text


@pytest.mark.parametrize(("code", "why"), [("P-PP", "has no id"), ("----", "is not found")])
def test_nothing_is_said_of_a_robot_that_its_shape_tells(code: str, why: str) -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", code, x, y, 0.0)
    read = np.zeros(1, dtype=ROBOT)
    read["id"], read["x_m"], read["y_m"] = 0, x + 0.01, y
    settings = settings_of("ssl-standard")
    assert why in "\n".join(map(str, explain_robots(scene_of(drawn), settings)))
    assert explain_robots(scene_of(drawn, read=read), settings) == []


def test_two_robots_with_one_id() -> None:
    drawn, x, y = picture(2.6)
    drawn.paint_robot("blue", CODES[3], x - 0.1, y, 0.3)
    drawn.paint_robot("blue", CODES[3], x + 0.1, y, 1.3)
    assert "two robots have the marker of blue 3, so none of them has an id" in said(drawn)


def test_a_code_that_no_id_has() -> None:
    square = load_pattern("vsss-three-patch")
    drawn = empty_picture(square)
    pose = (*middle(drawn, square.robot.height_m), 0.5)
    drawn.paint_pattern(square, "blue", "RR", pose)
    assert "has the code RR, which is no id of pattern vsss-three-patch" in said(drawn, "vsss-three-patch")


def test_markers_of_another_league_are_recognized() -> None:
    square = load_pattern("vsss-three-patch")
    drawn = empty_picture(square, 2.6)
    x, y = middle(drawn, square.robot.height_m)
    drawn.paint_pattern(square, "blue", square.code_by_id[2], (x - 0.045, y, 0.5))
    drawn.paint_pattern(square, "blue", square.code_by_id[9], (x + 0.045, y, 2.5))
    assert "robots.pattern = 'vsss-three-patch' 2 robots would be identified" in said(drawn)
