"""A mirror is fitted over the API: pairs as rows or text, the verdict with curve and band, refusals by row."""

import time
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest

from app.web.blackboard import Blackboard
from tests.app.fake_service import Scene, asked_by_operator, running_service, wait_for
from tests.calibration.mirror.pictures import around
from vision_core.geometry import Bytes
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.native.opencv import encode_png

FILE = {"Content-Type": "application/octet-stream"}
PATIENCE_S = 240.0

DISTANCES = [110.0, 150.0, 220.0, 300.0, 380.0, 500.0, 700.0, 1000.0, 1500.0, 2000.0, 2750.0]
PAIRS = [{"r_px": round(PAPER_MIRROR.px_from_mm(mm), 1), "r_mm": mm} for mm in DISTANCES]
TEXT = "r [mm];R [px]\n" + "\n".join(f"{pair['r_mm']};{pair['r_px']}".replace(".", ",") for pair in PAIRS)


@pytest.fixture(scope="module")
def http() -> Iterator[httpx.Client]:
    with running_service(Scene()) as service, asked_by_operator(service, PATIENCE_S) as client:
        yield client


def fitted(http: httpx.Client, body: dict[str, object]) -> dict[str, object]:
    begun = http.post("/calibration/mirror", json=body)
    assert begun.status_code == 202, begun.text
    assert begun.json()["work"] == "mirror"
    wait_for(lambda: http.get("/calibration").json()["state"] != "running", PATIENCE_S)
    report = http.get("/calibration").json()
    assert report["state"] == "done", report["error"]
    return dict(report["mirror"])


def test_pairs_give_a_mirror_with_its_curve(http: httpx.Client) -> None:
    wrong = {"r_px": 60.0, "r_mm": 2000.0, "name": "the goal"}
    found = fitted(http, {"pairs": [*PAIRS, wrong], "focal_px": 300.0})
    assert found["accepted"], found["reasons"]
    constants = found["constants"]
    assert isinstance(constants, dict)
    assert constants["horizon_px"] == pytest.approx(PAPER_MIRROR.horizon_px, abs=0.3)
    assert constants["deviations"][2] / constants["c"] < 0.2
    curve = found["curve"]
    assert isinstance(curve, list)
    off = [point["r_px"] - PAPER_MIRROR.px_from_mm(point["r_mm"]) for point in curve]
    assert np.abs(off).max() < 0.1
    pairs = found["pairs"]
    assert isinstance(pairs, list)
    assert [pair["name"] for pair in pairs if not pair["counts"]] == ["the goal"]
    assert "the goal (-36.9 px) left out" in str(found["notes"])


def test_text_is_refused_by_line_and_too_few_pairs_with_what_is_missing(http: httpx.Client) -> None:
    found = fitted(http, {"text": TEXT})
    assert found["accepted"], found["reasons"]
    assert found["words"]
    few = fitted(http, {"text": "\n".join(TEXT.splitlines()[:4])})
    assert (few["accepted"], few["constants"], few["curve"]) == (False, None, [])
    assert "3 distances are not enough" in str(few["reasons"])
    bad = http.post("/calibration/mirror", json={"text": TEXT + "\n500;x"})
    assert (bad.status_code, bad.json()["field"]) == (422, "text")
    assert bad.json()["asked"] == "the text, line 13"
    bad = http.post("/calibration/mirror", json={"pairs": [*PAIRS, {"r_px": 0.0, "r_mm": 1.0}]})
    assert (bad.status_code, bad.json()["field"], bad.json()["asked"]) == (422, "pairs", "row 12")
    bad = http.post("/calibration/mirror", json={"pairs": PAIRS, "focal_deviation_px": 3.0})
    assert bad.json()["field"] == "focal_px"
    long = fitted(http, {"text": "\n".join([TEXT] + TEXT.splitlines()[1:] * 100)})
    assert len(long["pairs"]) == 1111  # type: ignore[arg-type]


def given(http: httpx.Client, name: str, pixels: Bytes) -> int:
    """Give an on-board picture; its number."""
    answer = http.post(f"/calibration/pictures?of=onboard&name={name}", content=encode_png(pixels), headers=FILE)
    assert answer.status_code == 200, answer.text
    return int(answer.json()["onboard"][-1]["number"])


def test_a_click_on_a_target_gives_the_radius_of_a_pair(http: httpx.Client) -> None:
    number = given(http, "a.png", around(np.full(360, 61.3)))
    edge = http.post("/calibration/mirror/edge", json={"picture": number, "place_px": [159.5, 62.0]})
    assert edge.status_code == 200, edge.text
    assert edge.json()["r_px"] == pytest.approx(61.3, abs=0.15)
    assert edge.json()["place_px"][1] == pytest.approx(119.5 - edge.json()["r_px"])
    rim = http.post("/calibration/mirror/edge", json={"picture": number, "direction_deg": 90.0, "scale": 2.0}).json()
    assert rim["r_px"] == pytest.approx(115.0 / 2.0, abs=0.2)
    none = http.post("/calibration/mirror/edge", json={"picture": number, "place_px": [159.5, 85.0]})
    assert (none.status_code, none.json()["asked"]) == (422, "an edge in a.png")
    assert http.post("/calibration/mirror/edge", json={"picture": 999}).status_code == 404
    assert http.delete("/calibration/pictures?of=onboard").json()["onboard"] == []


def looked(http: httpx.Client, body: dict[str, object]) -> dict[str, Any]:
    """What becomes of looking around a robot."""
    begun = http.post("/calibration/mirror/around", json=body)
    assert (begun.status_code, begun.json().get("work")) == (202, "pairs"), begun.text
    wait_for(lambda: http.get("/calibration").json()["state"] != "running", PATIENCE_S)
    return dict(http.get("/calibration").json())


def test_a_picture_and_what_stands_around_the_robot(http: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    distances = 300.0 + 750.0 * (1.0 - np.cos(np.radians(2.0 * np.arange(360.0))))
    number = given(http, "b.png", around(PAPER_MIRROR.px_from_mm(distances)))
    text = "\n".join(f"{degree} {distance:.1f}" for degree, distance in enumerate(distances.tolist()))
    pairs = looked(http, {"picture": number, "text": text})["found"]
    assert len(pairs) > 300
    assert pairs[0]["name"].startswith("b.png at ")
    assert pairs[0]["place_px"] == pytest.approx([159.5, 119.5 - pairs[0]["r_px"]])
    typed = [{key: value for key, value in pair.items() if key != "place_px"} for pair in pairs]
    found = fitted(http, {"pairs": typed, "focal_px": 300.0})
    assert found["accepted"], found["reasons"]
    assert "all pairs of pictures share errors" in str(found["notes"])
    assert "stands around the robot of b.png, line 1" in looked(http, {"picture": number, "text": "0;x"})["error"]

    rim = http.post("/calibration/mirror/rim", json={"picture": number}).json()
    assert (*rim["center_px"], rim["radius_px"]) == pytest.approx((159.5, 119.5, 115.0), abs=0.5)
    bright = given(http, "bright.png", np.full((240, 320, 3), 200, dtype=np.uint8))
    none = http.post("/calibration/mirror/rim", json={"picture": bright})
    assert (none.status_code, none.json()["found"]) == (422, "corners of brightness 200 of 255")
    other = http.post(
        "/calibration/pictures?of=onboard&name=o.png", content=encode_png(np.zeros((9, 9, 3), np.uint8)), headers=FILE
    )
    assert other.status_code == 422, "another size"
    monkeypatch.setattr(Blackboard, "picture", lambda _self: None)
    assert http.post(f"/calibration/pictures/{number}/ceiling").status_code == 503
    assert http.get("/calibration").json()["onboard"][-1]["ceiling_s"] == pytest.approx(time.time(), abs=300.0)
    later = given(http, "c.png", around(np.full(360, 61.3)))
    refused = http.post("/calibration/mirror/around", json={"picture": later, "team": "yellow", "number": 2})
    assert (refused.status_code, refused.json()["found"]) == (409, "no picture of the ceiling camera of its time")
