"""Everything that a referee changes, over the API: settings, teams, match, clients; with undo, conflicts, import."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import httpx
import pytest

from tests.app.fake_service import FakeService, PageServer, Scene, wait_for
from vision_core.protocol.error_codes import ErrorCode
from vision_core.rtdb import records
from vision_core.rtdb.infos import LiveSettings, RefusedRequest
from vision_core.types.objects import Team

API = "/api/v1"
COLOGNE = {"name": "1. FC Köln", "short_name": "CGN", "contact": "Ada, 0221", "robots": [7, 3, 1, 9, 4]}


@pytest.fixture
def service() -> Iterator[FakeService]:
    service = FakeService(Scene(clients=2))
    service.start()
    yield service
    service.stop()


@pytest.fixture
def http(service: FakeService) -> Iterator[httpx.Client]:
    server = PageServer(service)
    server.start()
    with httpx.Client(base_url=f"http://{server.address}{API}", headers=service.operator) as client:
        wait_for(lambda: httpx.get(f"http://{server.address}/healthz").status_code == 200)
        yield client
    server.stop()


def live(service: FakeService) -> LiveSettings:
    """What every process applies at the next frame."""
    return records.LIVE_SETTINGS.reader(service.store).value(service.clock.now())


def settings_of(http: httpx.Client) -> dict[str, dict[str, Any]]:
    return {setting["key"]: setting for setting in http.get("/settings").json()["settings"]}


def revision(http: httpx.Client) -> int:
    return int(http.get("/settings").json()["revision"])


def test_every_setting_has_value_words_and_limits(http: httpx.Client) -> None:
    settings = settings_of(http)
    side = settings["match.blue_defends"]
    assert (side["kind"], side["choices"], side["value"], side["is_live"]) == (
        "choice",
        ["left", "right"],
        "left",
        True,
    )
    assert side["description"] == "left: the goal at negative x"
    rate = settings["camera.rate_hz"]
    assert (rate["kind"], rate["maximum"], rate["is_live"]) == ("number", 1000.0, False)
    assert settings["colors.classes"]["kind"] == "json"
    assert settings["robots.pattern"]["kind"] == "text"
    assert len(settings) > 100


def test_a_live_setting_reaches_the_processes_at_once(http: httpx.Client, service: FakeService) -> None:
    change = http.patch("/settings", json={"revision": 0, "changes": {"tracks.validity_ms": 400.0}}).json()
    assert change["entries"] == [{"key": "settings/tracks.validity_ms", "before": None, "after": 400.0}]
    assert change["needs_restart"] == []
    assert (live(service).tracks.validity_ms, live(service).revision) == (400.0, 1)
    changed = settings_of(http)["tracks.validity_ms"]
    assert (changed["is_changed"], changed["file_value"], changed["waits_for_restart"]) == (True, 250.0, False)


def test_another_setting_waits_for_the_next_start_and_says_so(http: httpx.Client) -> None:
    change = http.patch("/settings", json={"changes": {"camera.shutter_delay_ms": 20.0}}).json()
    assert change["needs_restart"] == ["camera.shutter_delay_ms"]
    assert http.get("/settings").json()["waits_for_restart"] == ["camera.shutter_delay_ms"]


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"match.blue_defends": "up"}, "match.blue_defends", "left, right"),
        ({"match.blue_defend": "left"}, "match.blue_defend", "did you mean blue_defends"),
        ({"match.blue_ids": [1, 2]}, "match.blue_ids", "at least match.numbers"),
        ({"tracks.validity_ms": -1}, "tracks.validity_ms", "> 0.0"),
        ({"mirror.blue": {"a": 1.0, "b": 2.0, "c": 9e4}}, "mirror.blue", "A > B sqrt"),
    ],
)
def test_a_value_that_cannot_be_is_refused_by_name_and_nothing_changes(
    http: httpx.Client, service: FakeService, changes: dict[str, Any], field: str, words: str
) -> None:
    before = live(service)
    answer = http.patch("/settings", json={"changes": changes})
    problem = answer.json()
    assert (answer.status_code, problem["field"]) == (422, field)
    assert words in problem["detail"]
    assert (live(service), revision(http)) == (before, 0)


def test_two_browsers_do_not_overwrite_each_other(http: httpx.Client) -> None:
    http.patch("/settings", json={"revision": 0, "changes": {"match.blue_defends": "right"}})
    late = http.patch("/settings", json={"revision": 0, "changes": {"match.blue_defends": "left"}})
    assert late.status_code == 409
    assert "in revision 1" in late.json()["found"]
    other = http.patch("/settings", json={"revision": 0, "changes": {"tracks.gate_m": 0.3}})
    assert other.status_code == 200


def test_undo_redo_and_history(http: httpx.Client, service: FakeService) -> None:
    http.post("/match/swap_sides", json={})
    assert live(service).match.blue_defends == "right"
    undone = http.post("/settings/undo", json={"revision": 1}).json()
    assert (undone["kind"], undone["what"]) == ("undo", "undo: swap sides")
    assert live(service).match.blue_defends == "left"
    assert http.post("/settings/redo", json={"revision": 2}).status_code == 200
    assert live(service).match.blue_defends == "right"
    assert [change["what"] for change in http.get("/settings/history").json()] == [
        "redo: swap sides",
        "undo: swap sides",
        "swap sides",
    ]
    assert http.post("/settings/redo", json={"revision": 3}).json()["found"] == "nothing to redo"


def test_a_team_registers_plays_swaps_color_and_leaves(http: httpx.Client, service: FakeService) -> None:
    made = http.post("/teams", json=COLOGNE)
    assert (made.status_code, made.json()["slug"]) == (201, "cgn")
    assert http.post("/teams", json=COLOGNE).status_code == 409
    http.patch("/match", json={"blue": "cgn"})
    assert (live(service).match.blue_name, live(service).match.blue_ids) == ("1. FC Köln", (7, 3, 1, 9, 4))
    http.post("/match/swap_colors", json={})
    assert (live(service).match.blue_name, live(service).match.yellow_name) == ("", "1. FC Köln")
    assert http.get("/match").json()["yellow"] == "cgn"
    assert http.get("/teams").json()[0]["plays"] == "yellow"
    http.delete("/teams/cgn")
    assert (http.get("/teams").json(), live(service).match.yellow_name) == ([], "")


@pytest.mark.parametrize(
    ("changed", "field"),
    [({"name": " "}, "name"), ({"short_name": "!!!"}, "short_name"), ({"robots": [300]}, "robots.0"), ({"x": 1}, "x")],
)
def test_a_team_that_cannot_be_is_refused_by_field(http: httpx.Client, changed: dict[str, Any], field: str) -> None:
    answer = http.post("/teams", json={**COLOGNE, **changed, **({"name": "!"} if field == "short_name" else {})})
    assert (answer.status_code, answer.json()["field"]) == (422, field)


def test_a_team_with_too_few_markers_cannot_play(http: httpx.Client) -> None:
    http.post("/teams", json={**COLOGNE, "robots": [7]})
    answer = http.patch("/match", json={"blue": "cgn"})
    assert (answer.status_code, answer.json()["field"]) == (422, "match.blue_ids")
    assert http.get("/match").json()["blue"] is None


def test_a_team_does_not_play_against_itself(http: httpx.Client) -> None:
    http.post("/teams", json=COLOGNE)
    assert http.patch("/match", json={"blue": "cgn", "yellow": "cgn"}).status_code == 409
    assert http.patch("/match", json={"blue": "nobody"}).json()["field"] == "blue"


def test_the_pages_field_has_the_mirror_in_effect(http: httpx.Client) -> None:
    before = http.get("/field").json()["mirror_m"]["blue"]
    http.patch("/settings", json={"changes": {"mirror.a": 4.4, "mirror.b": 0.0138}})
    assert http.get("/field").json()["mirror_m"]["blue"] != before


def test_who_waits_is_admitted_for_a_time_and_turned_away(http: httpx.Client, service: FakeService) -> None:
    now = service.clock.now()
    waiting = RefusedRequest("10.0.0.7", 4711, Team.BLUE, 3, ErrorCode.NOT_ADMITTED.value, now, now, 4)

    def waits() -> dict[str, Any] | None:
        serving = records.SERVING.reader(service.store).read(service.clock.now())
        if serving is not None:
            service.put(records.SERVING, replace(serving.value, refused=(waiting,)))
        return next(iter(http.get("/clients").json()["waiting"]), None)

    wait_for(lambda: waits() is not None)
    row = waits()
    if row is not None:
        assert (row["address"], row["team"], row["number"], row["can_be_admitted"]) == ("10.0.0.7", "blue", 3, True)
        assert row["reason"] == "its address is not admitted"
    admitted = http.post("/admissions", json={"network": "10.0.0.7", "team": "blue", "number": 3, "minutes": 30})
    assert admitted.status_code == 201
    (rule,) = live(service).admission.rules
    assert (rule.network, rule.team, rule.number) == ("10.0.0.7", "blue", 3)
    http.post("/refusals", json={"address": "10.0.0.8"})
    assert live(service).admission.refused == ("10.0.0.8",)
    clients = http.get("/clients").json()
    assert [each["address"] for each in clients["refused"]] == ["10.0.0.8"]
    http.delete(f"/admissions/{clients['admissions'][0]['id']}")
    http.delete("/refusals/10.0.0.8")
    assert (live(service).admission.rules, live(service).admission.refused) == ((), ())
    assert http.post("/admissions", json={"network": "laptop"}).json()["field"] == "network"
    assert http.delete("/admissions/9").status_code == 404


def test_a_client_is_disconnected(http: httpx.Client, service: FakeService) -> None:
    wait_for(lambda: bool(http.get("/clients").json()["connected"]))
    client = http.get("/clients").json()["connected"][0]
    assert http.delete(f"/clients/{client['team']}/{client['number']}").status_code == 204
    (ended,) = live(service).ended
    assert (ended.team.value, ended.number) == (client["team"], client["number"])
    assert http.delete("/clients/blue/16").status_code == 404


def test_export_and_import_into_an_empty_server(http: httpx.Client, service: FakeService) -> None:
    http.post("/teams", json=COLOGNE)
    http.patch("/match", json={"blue": "cgn", "blue_defends": "right"})
    exported = http.get("/settings/export")
    assert "attachment" in exported.headers["content-disposition"]
    for _ in range(2):
        http.post("/settings/undo", json={"revision": revision(http)})
    assert http.get("/teams").json() == []
    preview = http.post("/settings/import?preview=true", json=exported.json()).json()
    assert [entry["key"] for entry in preview["entries"]] == ["plays/blue", "settings/match.blue_defends", "teams/cgn"]
    assert http.get("/teams").json() == []
    http.post("/settings/import", json=exported.json())
    assert live(service).match.blue_name == "1. FC Köln"
    foreign = http.post("/settings/import", json={**exported.json(), "format": "photonvision"})
    assert (foreign.status_code, "photonvision" in foreign.json()["detail"]) == (422, True)
