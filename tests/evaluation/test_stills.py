"""Stills: one table per picture, errors that do not stop the rest, and the real venue of Rosenheim."""

import json
import math
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from tests.objects.drawing import CODES, SETTINGS, Picture, overhead_camera
from vision_core.errors import SourceError
from vision_core.evaluation.stills import detect_files
from vision_core.models.camera import PinholeCamera
from vision_core.native.opencv import read_picture, write_picture
from vision_core.settings.schema import Settings
from vision_core.venues.loader import load_settings

ROSENHEIM = Path(__file__).parents[2].parent / "shared" / "data" / "real" / "ssl-rosenheim"
WIDTH, HEIGHT = 160, 120


@pytest.fixture(scope="module")
def settings() -> Settings:
    camera = overhead_camera(0.005, WIDTH, HEIGHT)
    assert isinstance(camera, PinholeCamera)
    lens = msgspec.structs.replace(
        SETTINGS.camera.pinhole,
        focal_px=camera.focal_px,
        center_px=(WIDTH / 2, HEIGHT / 2),
        distortion=(0.0, 0.0, 0.0, 0.0, 0.0),
        position_m=tuple(camera.position_m.tolist()),
        rotation_deg=(2.0, -1.0, 20.0),
    )
    changed = msgspec.structs.replace(SETTINGS.camera, width_px=WIDTH, height_px=HEIGHT, pinhole=lens)
    unpainted = msgspec.structs.replace(SETTINGS.field, line_width_m=0.0)
    return msgspec.structs.replace(SETTINGS, camera=changed, field=unpainted)


@pytest.fixture(scope="module")
def still(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A picture of blue 6, and a ball."""
    drawn = Picture(overhead_camera(0.005, WIDTH, HEIGHT), WIDTH, HEIGHT)
    x, y = drawn.camera.field_from_pixel(np.array([[60.0, 50.0]]), SETTINGS.robots.height_m)[0].tolist()
    drawn.paint_robot("blue", CODES[6], x, y, 0.5)
    drawn.paint_ball(x + 0.2, y - 0.1)
    path = tmp_path_factory.mktemp("stills") / "one.png"
    write_picture(path, drawn.as_bytes())
    return path


def test_a_picture_becomes_one_table(settings: Settings, still: Path) -> None:
    (found,) = detect_files([still], settings, None)
    table: dict[str, Any] = json.loads(json.dumps(found))
    assert set(table) == {"file", "robots", "balls", "obstacles", "reasons"}
    assert table["file"] == str(still)
    assert [set(robot) for robot in table["robots"]] == [
        {"team", "id", "x_px", "y_px", "x_m", "y_m", "heading_rad", "confidence", "position_sd_m", "heading_sd_rad"}
    ]
    assert [set(ball) for ball in table["balls"]] == [{"x_px", "y_px", "x_m", "y_m", "confidence", "position_sd_m"}]
    (robot,) = table["robots"]
    assert (robot["team"], robot["id"]) == ("blue", 6)
    assert math.dist((robot["x_px"], robot["y_px"]), (60.0, 50.0)) < 0.4
    assert table["reasons"] == []


def test_bad_files_are_named_and_the_rest_goes_on(settings: Settings, still: Path, tmp_path: Path) -> None:
    text, small = tmp_path / "text.jpg", tmp_path / "small.png"
    text.write_text("no picture")
    write_picture(small, np.zeros((20, 30, 3), dtype=np.uint8))
    results = list(detect_files([text, tmp_path / "none.png", small, still], settings, None))
    assert [set(result) == {"file", "error"} for result in results] == [True, True, True, False]
    assert "no picture" in str(results[0]["error"])
    assert "No such file" in str(results[1]["error"])
    assert "found: 30x20 px; accepted: 160x120" in str(results[2]["error"])
    assert results[3]["robots"]


def test_every_picture_is_judged_alone(settings: Settings, still: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty.png"
    write_picture(empty, np.full((HEIGHT, WIDTH, 3), 60, dtype=np.uint8))
    one, nothing, again = detect_files([still, empty, still], settings, None)
    assert one == again
    assert (nothing["robots"], nothing["balls"]) == ([], [])
    assert nothing["reasons"]


def test_overlays_mark_robot_and_ball_on_a_copy(settings: Settings, still: Path, tmp_path: Path) -> None:
    before = still.read_bytes()
    list(detect_files([still], settings, tmp_path / "made" / "here"))
    overlay = read_picture(tmp_path / "made" / "here" / "one.png").astype(int)
    changed = np.abs(overlay - read_picture(still)).max(axis=2) > 60
    assert changed[45:56, 80:160].any(), "a label beside the robot"
    assert changed[50 - 22 : 50 + 22, 60 - 22 : 60 + 22].sum() > 60, "its outline and heading"
    assert not changed[50, 42:56].all()
    assert still.read_bytes() == before


def test_the_class_picture_shows_what_segmentation_makes_of_it(settings: Settings, still: Path, tmp_path: Path) -> None:
    list(detect_files([still], settings, tmp_path))
    drawn = read_picture(tmp_path / "one-classes.png").astype(int)
    colored = np.ptp(drawn, axis=2) > 30
    assert colored[50, 60], "the center dot"
    assert 0.002 < colored.mean() < 0.1, "carpet and body have no class"


def test_a_folder_that_cannot_be_made_is_an_error(settings: Settings, still: Path) -> None:
    with pytest.raises(SourceError, match="for overlays"):
        list(detect_files([still], settings, still / "below"))


@pytest.fixture(scope="module")
def rosenheim() -> dict[str, Any]:
    """A real field: six robots, balls on the field and beside it, decoys."""
    if not ROSENHEIM.is_dir():
        pytest.skip("the real pictures are not here")
    (found,) = detect_files([ROSENHEIM / "frame.jpg"], load_settings("ssl-rosenheim"), None)
    return found


def test_rosenheim_all_robots_and_no_other(rosenheim: dict[str, Any]) -> None:
    truth = json.loads((ROSENHEIM / "truth.json").read_text())["frame.jpg"]["robots"]
    robots = {(robot["team"], robot["id"]): robot for robot in rosenheim["robots"]}
    assert set(robots) == {(robot["team"], robot["id"]) for robot in truth}
    for robot in truth:
        seen = robots[robot["team"], robot["id"]]
        assert math.dist((seen["x_px"], seen["y_px"]), robot["centre_px"]) <= 5.0
        assert seen["confidence"] > 0.8


def test_rosenheim_the_orange_balls_inside_the_walls_and_no_decoy(rosenheim: dict[str, Any]) -> None:
    """On the field, in the left goal and at the lower wall; the box, the white ball and the football are none."""
    balls = [(ball["x_px"], ball["y_px"]) for ball in rosenheim["balls"]]
    for place in [(1327, 428), (151, 636), (1110, 1037)]:
        assert any(math.dist(place, ball) <= 5.0 for ball in balls), place
    assert len(balls) == 3
