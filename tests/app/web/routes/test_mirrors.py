"""The mirrors in force over the API: of the field, of a team, of one robot; previewed, set, taken back, refused."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from tests.app.fake_service import FakeService
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.rtdb import records

MIRROR = {"a": 4.2, "b": 0.0131, "c": 91000.0}
OTHER = {"a": 4.4, "b": 0.0138, "c": 90000.0}


@pytest.fixture
def http(operator: httpx.Client) -> Iterator[httpx.Client]:
    yield operator
    operator.patch("/match", json={"mode": "practice"})
    for scope in ("blue/3", "yellow/1", "blue", "yellow", "field"):
        assert operator.delete(f"/mirrors/{scope}").status_code == 200


def live(service: FakeService) -> Any:
    reading = records.LIVE_SETTINGS.reader(service.store).read(service.clock.now())
    assert reading is not None
    return reading.value.mirror


def in_force(http: httpx.Client) -> dict[str, tuple[float, str, bool]]:
    """A, who gives the mirror, and whether the page has changed it; by scope."""
    mirrors = http.get("/mirrors").json()["mirrors"]
    return {each["scope"]: (each["a"], each["given_by"], each["is_changed"]) for each in mirrors}


def test_all_mirrors_in_force_and_who_gives_them(http: httpx.Client, service: FakeService) -> None:
    shown = in_force(http)
    assert list(shown)[:4] == ["field", "blue", "yellow", "blue 1"]
    assert len(shown) == 3 + 2 * service.settings.match.numbers
    assert set(shown.values()) == {(PAPER_MIRROR.a, "field", False)}
    assert http.put("/mirrors/blue", json=MIRROR).status_code == 200
    assert http.put("/mirrors/blue/3", json=OTHER).status_code == 200
    shown = in_force(http)
    assert shown["blue"] == (4.2, "blue", True)
    assert shown["blue 2"] == (4.2, "blue", False)
    assert shown["blue 3"] == (4.4, "blue 3", True)
    assert shown["yellow 3"] == (PAPER_MIRROR.a, "field", False)
    assert (live(service).blue.a, live(service).robots["blue 3"].a) == (4.2, 4.4)
    one = http.get("/mirrors/blue/3").json()
    assert (one["a"], one["given_by"], http.get("/mirrors/blue").json()["a"]) == (4.4, "blue 3", 4.2)
    assert one["height_mm"] == pytest.approx(one["focal_px"] / (4.4**2 - 0.0138**2 * 9e4) ** 0.5)
    table = http.get("/field").json()["mirror_m"]
    assert table["blue 3"] != table["blue"] != table["yellow"]
    assert "blue 2" not in table


def test_the_fields_mirror_changes_for_those_that_have_no_other(http: httpx.Client) -> None:
    http.put("/mirrors/yellow/1", json=OTHER)
    http.put("/mirrors/field", json=MIRROR)
    shown = in_force(http)
    assert (shown["field"][0], shown["yellow"][0], shown["yellow 1"][0]) == (4.2, 4.2, 4.4)
    http.delete("/mirrors/field")
    assert in_force(http)["field"] == (PAPER_MIRROR.a, "field", False)


def test_a_change_of_one_robot_is_in_the_history_and_is_undone(http: httpx.Client, service: FakeService) -> None:
    made = http.put("/mirrors/blue/3", json=OTHER).json()
    assert [entry["key"] for entry in made["entries"]] == ["settings/mirror.robots.blue 3"]
    assert made["needs_restart"] == []
    settings = {each["key"]: each for each in http.get("/settings").json()["settings"]}
    assert settings["mirror.robots.blue 3"]["value"] == OTHER
    assert settings["mirror.robots.blue 3"]["is_live"]
    assert http.post("/settings/undo", json={"revision": made["revision"]}).status_code == 200
    assert live(service).robots == {}


def test_what_the_settings_page_gives_robots_is_the_same_entry(http: httpx.Client, service: FakeService) -> None:
    set_all = {"changes": {"mirror.robots": {"blue 3": OTHER, "yellow 1": MIRROR}}}
    assert http.patch("/settings", json=set_all).status_code == 200
    assert in_force(http)["blue 3"] == (4.4, "blue 3", True)
    assert http.delete("/mirrors/blue/3").status_code == 200
    assert in_force(http)["blue 3"] == (PAPER_MIRROR.a, "field", False)
    assert list(live(service).robots) == ["yellow 1"]
    assert http.patch("/settings", json={"changes": {"mirror.robots": {"blue 2": OTHER}}}).status_code == 200
    assert list(live(service).robots) == ["blue 2"]
    assert http.patch("/settings", json={"changes": {"mirror.robots": None}}).status_code == 200
    assert live(service).robots == {}
    assert http.patch("/settings", json={"changes": {"mirror.robots": 3}}).json()["field"] == "mirror.robots"


def test_who_is_not_the_operator_changes_no_mirror(http: httpx.Client) -> None:
    for method, path in (("PUT", "field"), ("PUT", "blue/3"), ("DELETE", "blue"), ("POST", "preview")):
        answer = http.request(method, f"/mirrors/{path}", json=MIRROR, headers={"authorization": "Bearer nobody"})
        assert answer.status_code == 401, answer.text
    assert in_force(http)["field"] == (PAPER_MIRROR.a, "field", False)


@pytest.mark.parametrize(
    ("scope", "field"),
    [("field", "mirror"), ("blue", "mirror.blue"), ("yellow/1", "mirror.robots.yellow 1")],
)
def test_a_mirror_that_cannot_be_is_refused_by_key(http: httpx.Client, scope: str, field: str) -> None:
    answer = http.put(f"/mirrors/{scope}", json={**MIRROR, "b": 5.0})
    assert (answer.status_code, answer.json()["field"], answer.json()["accepted"]) == (422, field, "A > B sqrt(C)")


def test_there_is_no_robot_17_and_no_third_team(http: httpx.Client) -> None:
    assert http.put("/mirrors/blue/17", json=MIRROR).status_code == 422
    assert http.put("/mirrors/green", json=MIRROR).status_code == 422
    assert http.put("/mirrors/blue", json={**MIRROR, "d": 1.0}).status_code == 422


def test_in_a_match_one_team_or_robot_gets_no_mirror_of_its_own(http: httpx.Client, service: FakeService) -> None:
    http.patch("/match", json={"mode": "match"})
    for scope, key in (("blue", "mirror.blue"), ("blue/3", "mirror.robots.blue 3")):
        answer = http.put(f"/mirrors/{scope}", json=MIRROR)
        assert (answer.status_code, answer.json()["field"]) == (422, key)
        assert "the same mirror for all robots of both teams" in answer.json()["accepted"]
    assert live(service).blue is None
    assert http.get("/mirrors").json()["is_match"] is True
    assert http.put("/mirrors/field", json=MIRROR).status_code == 200, "the same for all"


def test_a_match_does_not_begin_while_mirrors_differ(http: httpx.Client) -> None:
    http.put("/mirrors/blue/3", json=OTHER)
    answer = http.patch("/match", json={"mode": "match"})
    assert (answer.status_code, answer.json()["field"]) == (422, "mirror.robots.blue 3")
    assert http.get("/match").json()["mode"] == "practice"


def previewed(http: httpx.Client, mirror: dict[str, float], query: str = "") -> dict[str, Any]:
    answer = http.post(f"/mirrors/preview{query}", json=mirror)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def test_a_preview_has_the_curve_and_changes_nothing(http: httpx.Client) -> None:
    revision = http.get("/mirrors").json()["revision"]
    seen = previewed(http, {"a": PAPER_MIRROR.a, "b": PAPER_MIRROR.b, "c": PAPER_MIRROR.c}, "?color=blue&number=3")
    assert (seen["scope"], seen["violations"]) == ("blue 3", [])
    assert seen["mirror"]["horizon_px"] == pytest.approx(PAPER_MIRROR.horizon_px)
    assert [seen["mirror"][name] for name in ("focal_px", "height_mm", "bend")] == pytest.approx(
        [300.0, 219.0, 1.739], rel=1e-3
    )
    for point in seen["curve"]:
        assert point["r_px"] == pytest.approx(PAPER_MIRROR.px_from_mm(point["r_mm"]))
    assert seen["curve"][-1]["r_mm"] >= 3600.0
    assert http.get("/mirrors").json()["revision"] == revision
    assert http.post("/mirrors/preview?number=3", json=MIRROR).json()["field"] == "color"


@pytest.mark.parametrize(
    ("mirror", "constant", "accepted"),
    [
        ({**MIRROR, "c": 0.0}, "c", "C > 0"),
        ({**MIRROR, "b": -0.1}, "b", "B >= 0"),
        ({**MIRROR, "a": 1.0}, "", "A > B sqrt(C)"),
        ({**MIRROR, "b": 0.004}, "", "a horizon of 20..254 px"),
        ({"a": 1.0, "b": 0.04, "c": 100.0}, "", "at least 3 px"),
    ],
)
def test_a_preview_names_the_rule_that_is_broken(
    http: httpx.Client, mirror: dict[str, float], constant: str, accepted: str
) -> None:
    (violation,) = previewed(http, mirror)["violations"]
    assert (violation["constant"], violation["accepted"]) == (constant, accepted)


def test_a_preview_tells_what_a_match_refuses(http: httpx.Client) -> None:
    http.patch("/match", json={"mode": "match"})
    (violation,) = previewed(http, MIRROR, "?color=yellow")["violations"]
    assert "in match mode" in violation["found"]
    assert previewed(http, MIRROR)["violations"] == []
