"""The camera is calibrated over the API: by pictures, in a process of its own, taken over with undo; and its lens."""

from collections.abc import Iterator

import httpx
import numpy as np
import pytest

from app.web.blackboard import Blackboard, Picture
from bench.board_views import board_pictures
from bench.calibration_views import View, floor_error_m, view
from tests.app.fake_service import Scene, asked_by_operator, running_service, wait_for
from vision_core.calibration.find import corners_m
from vision_core.clock import Instant
from vision_core.geometry import Bytes
from vision_core.native.opencv import encode_png
from vision_core.settings.schema import PinholeSettings

pytestmark = pytest.mark.slow
FILE = {"Content-Type": "application/octet-stream"}


@pytest.fixture(scope="module")
def shown() -> View:
    return view(0)


@pytest.fixture
def http() -> Iterator[httpx.Client]:
    with running_service(Scene()) as service, asked_by_operator(service) as client:
        yield client


def take(http: httpx.Client, monkeypatch: pytest.MonkeyPatch, pixels: Bytes) -> None:
    """Take a picture that the camera has just made."""
    monkeypatch.setattr(Blackboard, "picture", lambda _self: Picture(7, Instant(1), pixels))
    taken = http.post("/calibration/pictures/camera?of=field")
    assert taken.status_code == 200
    (picture,) = taken.json()["pictures"]
    assert picture["name"] == "frame-7.png"
    assert http.get(f"/calibration/pictures/{picture['number']}.jpg").content.startswith(b"\xff\xd8")


def wait_for_end(http: httpx.Client) -> dict[str, object]:
    wait_for(lambda: http.get("/calibration").json()["state"] != "running", 90.0)
    return dict(http.get("/calibration").json())


def test_corners_that_were_dragged_give_a_camera_that_is_taken_over(
    http: httpx.Client, shown: View, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused = http.post("/calibration", json={"find": True})
    assert (refused.status_code, refused.json()["accepted"]) == (409, "take a picture first")
    take(http, monkeypatch, shown.pixels)
    corners = shown.truth.pixel_from_field(corners_m(shown.settings.field)) + 6.0
    height = float(shown.truth.position_m[2])
    assert http.post("/calibration", json={"corners_px": corners.tolist(), "height_m": height}).status_code == 202
    assert http.post("/calibration", json={"find": True}).status_code == 409, "one at a time"
    result = wait_for_end(http)["result"]
    assert isinstance(result, dict)
    assert result["accepted"], result["reasons"]
    assert result["rms_px"] < 0.5
    assert {len(line["points_px"]) > 1 for line in result["lines"]} == {True}

    change = http.post("/calibration/accept").json()
    assert "camera.pinhole.focal_px" in change["needs_restart"]
    values = {entry["key"].removeprefix("settings/camera.pinhole."): entry["after"] for entry in change["entries"]}
    lens = {key: values[key] for key in ("focal_px", "center_px", "distortion", "position_m", "rotation_deg")}
    assert floor_error_m(PinholeSettings(**lens), shown.truth, shown.settings.field) < 0.003
    assert http.post("/settings/undo", json={"revision": change["revision"]}).status_code == 200
    assert http.get("/settings").json()["waits_for_restart"] == []


def test_a_picture_without_a_field_is_refused_with_reasons(http: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    take(http, monkeypatch, np.full((480, 640, 3), 90, dtype=np.uint8))
    assert http.post("/calibration", json={"find": True}).status_code == 202
    result = wait_for_end(http)["result"]
    assert isinstance(result, dict)
    assert not result["accepted"]
    assert result["reasons"][0]["advice"]
    refused = http.post("/calibration/accept")
    assert refused.status_code == 409
    assert result["reasons"][0]["text"] in refused.json()["found"]


def test_corners_that_no_camera_sees_are_named(
    http: httpx.Client, monkeypatch: pytest.MonkeyPatch, shown: View
) -> None:
    take(http, monkeypatch, shown.pixels)
    assert http.post("/calibration", json={"corners_px": [[9, 9], [9, 9], [9, 9], [9, 9]]}).status_code == 202
    ended = wait_for_end(http)
    assert ended["state"] == "failed"
    assert "three lie on one line" in str(ended["error"])
    assert http.post("/calibration", json={"corners_px": [[9, 9], [1e300, 9], [9, 1e300], [9, 9]]}).status_code == 202
    assert "accepted: pixels in or near the picture of 780x580" in str(wait_for_end(http)["error"])


def test_a_calibration_is_cancelled(http: httpx.Client, monkeypatch: pytest.MonkeyPatch, shown: View) -> None:
    take(http, monkeypatch, shown.pixels)
    assert http.post("/calibration", json={"find": True}).status_code == 202
    assert http.delete("/calibration").json()["state"] == "cancelled"
    wait_for(lambda: http.delete("/calibration/pictures?of=field").status_code == 200, 20.0)
    assert http.get("/calibration").json()["pictures"] == []
    assert http.get("/calibration").json()["result"] is None


def test_pictures_that_were_given_count_together_and_the_one_that_moved_is_named(
    http: httpx.Client, shown: View
) -> None:
    moved = np.roll(shown.pixels, 9, axis=1)
    for name, pixels in (("a.png", shown.pixels), ("b.png", shown.pixels), ("c.png", moved)):
        given = http.post(f"/calibration/pictures?of=field&name={name}", content=encode_png(pixels), headers=FILE)
        assert given.status_code == 200, given.text
    refused = http.post("/calibration/pictures?of=field&name=d.png", content=b"none", headers=FILE)
    assert (refused.status_code, refused.json()["asked"]) == (422, "picture d.png")
    small = encode_png(shown.pixels[:-2])
    other = http.post("/calibration/pictures?of=field&name=e.png", content=small, headers=FILE)
    assert "780x580 as the first picture" in other.json()["accepted"]

    http.post("/calibration", json={"find": True})
    result = wait_for_end(http)["result"]
    assert isinstance(result, dict)
    assert "c.png shows the field 9.0 px to the right" in result["reasons"][0]["text"]
    assert http.delete("/calibration/pictures/3").status_code == 200
    assert http.delete("/calibration/pictures/3").status_code == 404
    http.post("/calibration", json={"find": True})
    result = wait_for_end(http)["result"]
    assert isinstance(result, dict)
    assert result["accepted"], result["reasons"]
    assert [one["name"] for one in result["pictures"]] == ["a.png", "b.png"]


def test_a_lens_is_measured_with_a_board_taken_over_and_taken_out(http: httpx.Client) -> None:
    refused = http.post("/calibration/lens")
    assert (refused.status_code, refused.json()["accepted"]) == (409, "take a picture first")
    assert http.get("/calibration/board.pdf?paper=A3").content.startswith(b"%PDF")
    for number, pixels in enumerate(board_pictures()):
        http.post(f"/calibration/pictures?of=board&name={number}.png", content=encode_png(pixels), headers=FILE)
    assert http.post("/calibration/lens").status_code == 202
    report = wait_for_end(http)
    lens = report["lens"]
    assert isinstance(lens, dict)
    assert (report["work"], report["result"], lens["accepted"]) == ("lens", None, True)
    assert len(lens["regions"]) == 9
    assert len(lens["pictures"][0]["corners"]) > 10

    change = http.post("/calibration/lens/accept").json()
    assert change.get("needs_restart") in (None, [])
    assert http.get("/calibration").json()["held_focal_px"] == lens["focal_px"]
    assert http.delete("/calibration/lens").status_code == 200
    assert http.get("/calibration").json()["held_focal_px"] is None
    assert http.post("/calibration/accept").status_code == 409
