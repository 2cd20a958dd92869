"""A venue is set up over the API: step by step, each in a process of its own; nothing that was given is lost."""

import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.web.blackboard import Blackboard, Picture
from tests.app.fake_service import Scene, asked_by_operator, running_service, wait_for
from tests.setup.demo import DemoPicture, demo_pictures
from vision_core.clock import Instant
from vision_core.native.opencv import encode_png
from vision_core.venues.loader import load_settings

pytestmark = [pytest.mark.slow, pytest.mark.timeout(400)]  # the first trial may have to compile

OCTETS = {"content-type": "application/octet-stream"}
HEIGHT_M = 3.75


@pytest.fixture(scope="module")
def shown() -> tuple[DemoPicture, ...]:
    return demo_pictures(2)


@pytest.fixture
def http(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[httpx.Client]:
    with running_service(Scene()) as service, asked_by_operator(service, 90.0) as client:
        monkeypatch.setattr("app.web.routes.new_venue.own_venues_folder", lambda: tmp_path)
        monkeypatch.setattr("app.web.reports.new_venue.own_venues_folder", lambda: tmp_path)
        monkeypatch.setattr("vision_core.setup.venue_file.own_venues_folder", lambda: tmp_path)
        yield client


def give(http: httpx.Client, name: str, data: bytes) -> httpx.Response:
    return http.post("/new-venue/pictures", params={"name": name}, content=data, headers=OCTETS)


def wait_for_end(http: httpx.Client) -> dict[str, Any]:
    wait_for(lambda: http.get("/new-venue").json()["state"] != "running", 240.0)
    return dict(http.get("/new-venue").json())


def test_a_venue_from_pictures_to_the_settings_in_use(
    http: httpx.Client, shown: tuple[DemoPicture, ...], tmp_path: Path
) -> None:
    for number, picture in enumerate(shown):
        assert give(http, f"frame {number}.png", encode_png(picture.pixels)).status_code == 200
    assert http.patch("/new-venue", json={"pattern": "ssl-standard", "name": "demo-lab"}).status_code == 200
    assert http.post("/new-venue/field/accept", json={"preset": "ssl-2002"}).json()["camera"] is None
    assert http.post("/new-venue/camera", json={"begin": "find", "height_m": HEIGHT_M}).status_code == 202
    assert http.post("/new-venue/trial", json={}).status_code == 409, "one step at a time"
    found = wait_for_end(http)["found_camera"]
    assert (found["is_accepted"], found["is_current"], found["is_taken"]) == (True, True, False), found["reasons"]
    assert found["painted"] > 0.8
    taken = http.post("/new-venue/camera/accept", json={}).json()
    assert taken["camera"]["model"] == "pinhole"
    assert taken["found_camera"]["is_taken"]
    assert taken["missing_colors"] == ["orange", "blue", "pink", "green", "yellow"]

    for name, places in shown[0].papers().items():
        for x, y in places[:2]:
            answer = http.post("/new-venue/samples", json={"picture": 0, "x": x, "y": y, "name": name, "radius": 1})
            assert answer.status_code == 200, answer.text
    carpet = http.post("/new-venue/samples", json={"picture": 0, "x": 320, "y": 100, "name": "none"}).json()
    assert re.fullmatch("#[0-9a-f]{6}", carpet["color"])
    assert carpet["venue"]["missing_colors"] == []
    classes = {one["name"]: one["share"] for one in http.get("/new-venue/pictures/0/classes").json()["classes"]}
    assert set(classes) == {"orange", "blue", "pink", "green", "yellow"}
    assert 0.0 < classes["blue"] < 0.05
    assert http.get("/new-venue/pictures/0/classes.png").content.startswith(b"\x89PNG")

    assert http.post("/new-venue/trial", json={}).status_code == 202
    trial = wait_for_end(http)["trial"]
    assert trial["is_current"]
    for picture, seen in zip(shown, trial["pictures"], strict=True):
        ids = {(robot["team"], robot["id"]) for robot in seen["robots"]}
        assert {(str(team), number) for team, number in picture.ids()} <= ids, seen["reasons"]
        assert "robot" in seen["before"], "compared with the settings in use"
    assert http.get("/new-venue/pictures/1/overlay.png").content.startswith(b"\x89PNG")

    text = http.get("/new-venue/file").text
    assert text.startswith("# demo-lab. Set up on")
    assert http.post("/new-venue/use", json={}).status_code == 409, "not saved"
    saved = http.post("/new-venue/save", json={}).json()
    assert saved["path"] == f"{tmp_path}/demo-lab.toml"
    assert Path(saved["path"]).read_text() == text
    again = http.post("/new-venue/save", json={})
    assert (again.status_code, again.json()["field"]) == (409, "name")
    assert http.post("/new-venue/save", json={"replace": True}).status_code == 200
    assert {"camera.pinhole.position_m", "colors.samples"} <= {
        one["key"] for one in http.get("/new-venue/differences").json()
    }

    change = http.post("/new-venue/use", json={}).json()
    assert change["what"] == "venue demo-lab"
    assert "camera.pinhole.focal_px" in change["needs_restart"]
    wanted = load_settings(saved["path"])
    values = {one["key"]: one["value"] for one in http.get("/settings").json()["settings"]}
    assert values["camera.pinhole.focal_px"] == wanted.camera.pinhole.focal_px
    assert values["colors.classes"] == {}
    assert values["source.uri"] == "synthetic", "the file names no source"
    assert http.get("/new-venue/differences").json() == []
    assert http.post("/settings/undo", json={"revision": change["revision"]}).status_code == 200
    assert http.get("/settings").json()["waits_for_restart"] == []


def test_a_bad_picture_is_named_and_loses_nothing(http: httpx.Client, shown: tuple[DemoPicture, ...]) -> None:
    good = encode_png(shown[0].pixels)
    assert give(http, "good.png", good).status_code == 200
    grey = shown[0].pixels.copy()
    grey[...] = grey.mean(axis=2, keepdims=True)
    for name, data, words in (
        ("text.txt", b"hello", "no picture"),
        ("half.png", good[: len(good) // 2], "half.png"),
        ("small.png", encode_png(shown[0].pixels[:240]), "640x240 px; accepted: 640x480 as the first picture"),
        ("grey.png", encode_png(grey), "accepted: a picture in color"),
        ("empty.png", b"", "an empty file"),
    ):
        refused = give(http, name, data)
        assert refused.status_code == 422, name
        assert f"picture {name}" in refused.json()["detail"]
        assert words in refused.json()["detail"]
    venue = http.get("/new-venue").json()
    assert [picture["name"] for picture in venue["pictures"]] == ["good.png"]
    assert http.get("/new-venue/pictures/0.jpg?small=true").content.startswith(b"\xff\xd8")
    assert http.get("/new-venue/pictures/1.jpg").status_code == 404
    assert http.delete("/new-venue/pictures/0").json()["pictures"] == []
    assert http.post("/new-venue/undo", json={}).json()["pictures"] == venue["pictures"]


def test_the_newest_picture_of_the_camera_is_taken(
    http: httpx.Client, shown: tuple[DemoPicture, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Blackboard, "picture", lambda _self: Picture(7, Instant(1), shown[0].pixels))
    venue = http.post("/new-venue/pictures/camera", json={}).json()
    assert venue["pictures"] == [{"file": "1.png", "name": "frame-7.png", "width_px": 640, "height_px": 480}]


def test_choices_are_checked_as_a_whole(http: httpx.Client) -> None:
    before = http.get("/new-venue").json()
    for patch, field in (
        ({"name": "My Lab"}, None),
        ({"numbers": 40, "name": "lab"}, None),
        ({"preset": "nope"}, "preset"),
        ({"pattern": "../../x"}, "pattern"),
        ({"ball_color": ""}, None),
    ):
        refused = http.patch("/new-venue", json=patch)
        assert refused.status_code == 422, patch
        assert refused.json().get("field") == field
    assert http.patch("/new-venue", json={"name": "lab", "seen": 99}).status_code == 409
    assert http.get("/new-venue").json() == before
    told = http.patch("/new-venue", json={"numbers": 6, "ball_color": before["ball_color"]}).json()["undo"]
    assert told == "robots per team: 6", "what stays is not named"
    assert http.patch("/new-venue", json={"pattern": "vsss-diagonal"}).json()["undo"] == "markers vsss-diagonal"
    measures = http.get("/new-venue/choices").json()["fields"][0]["measures"]
    wrong = http.patch("/new-venue", json={"field": {**measures, "length_m": 0.01}})
    assert (wrong.status_code, wrong.json()["field"]) == (422, "field.length_m")
    own = http.patch("/new-venue", json={"field": {**measures, "length_m": 2.4}}).json()
    assert (own["field"]["length_m"], own["is_own_field"]) == (2.4, True)
    assert http.delete("/new-venue").json()["field"] is None
    assert http.post("/new-venue/undo", json={}).json()["field"]["length_m"] == 2.4


def test_steps_say_what_they_need(http: httpx.Client, shown: tuple[DemoPicture, ...]) -> None:
    assert http.post("/new-venue/field", json={}).json()["accepted"] == "a picture first"
    assert http.post("/new-venue/camera", json={"begin": "find"}).status_code == 409
    assert http.post("/new-venue/camera/accept", json={}).json()["accepted"] == "a search first"
    give(http, "a.png", encode_png(shown[0].pixels))
    sample = {"picture": 0, "x": 1, "y": 1, "name": "orange"}
    refused = http.post("/new-venue/samples", json=sample)
    assert (refused.status_code, refused.json()["asked"]) == (422, "the field")
    http.post("/new-venue/field/accept", json={"preset": "ssl-2002"})
    assert http.post("/new-venue/camera", json={"begin": "walls"}).status_code == 202
    ended = wait_for_end(http)
    assert (ended["state"], ended["job"]) == ("failed", "camera")
    assert "corners of the field; found: none" in ended["error"]
    assert http.get("/new-venue/differences").status_code == 409
    assert http.get("/new-venue/patterns/ssl-standard.svg?marker=3").text.startswith("<svg")
    assert http.get("/new-venue/patterns/ssl-standard.svg?marker=99").status_code == 404
    assert http.get("/new-venue/patterns/nope.svg").status_code == 404


def test_a_step_is_cancelled_and_the_draft_stays(http: httpx.Client, shown: tuple[DemoPicture, ...]) -> None:
    give(http, "a.png", encode_png(shown[0].pixels))
    assert http.post("/new-venue/field", json={}).status_code == 202
    assert http.delete("/new-venue/job").json()["state"] == "cancelled"
    wait_for(lambda: http.post("/new-venue/field", json={}).status_code == 202, 20.0)
    http.delete("/new-venue/job")
    time.sleep(0.2)
    venue = http.get("/new-venue").json()
    assert (venue["fields"], len(venue["pictures"])) == (None, 1)
    refused = http.post("/new-venue/colors/accept", json={})
    assert (refused.status_code, refused.json()["found"]) == (409, "none yet")
    wait_for(lambda: http.post("/new-venue/colors", json={}).status_code == 202, 20.0)
    ended = wait_for_end(http)
    assert (ended["job"], ended["state"]) == ("colors", "failed")
    assert "the field; found: not chosen yet" in ended["error"]


def test_it_is_the_operators_alone(http: httpx.Client) -> None:
    for path in ("/new-venue", "/new-venue/pictures/0.jpg", "/new-venue/file", "/new-venue/choices"):
        assert httpx.get(f"{http.base_url}{path.removeprefix('/')}").status_code == 401, path
