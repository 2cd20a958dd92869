"""The score of a simulated match over the API, and a new game."""

from collections.abc import Iterator

import httpx
import pytest

from tests.app.fake_service import GAME, FakeService, Scene, asked_by_operator
from vision_core.rtdb import records


@pytest.fixture(scope="module")
def service() -> FakeService:
    return FakeService(Scene())


@pytest.fixture(scope="module")
def http(service: FakeService) -> Iterator[httpx.Client]:
    with asked_by_operator(service) as client:
        yield client


def games(service: FakeService) -> int:
    reading = records.LIVE_SETTINGS.reader(service.store).read(service.clock.now())
    return reading.value.games if reading else 0


def test_a_match_that_is_not_simulated_has_no_score(http: httpx.Client) -> None:
    for answer in (http.get("/game"), http.post("/game")):
        assert answer.status_code == 404
        assert answer.json()["accepted"] == "a simulated match that has begun: pslv serve without a camera"


def test_the_score_and_who_drives(http: httpx.Client, service: FakeService) -> None:
    service.put(records.GAME, GAME)
    game = http.get("/game").json()
    assert (game["blue"], game["yellow"]["goals"], game["owner"]) == ({"goals": 2, "possession_s": 90.0}, 1, "blue")
    assert game["driven"] == [
        {"team": "blue", "number": 1, "silent": False},
        {"team": "yellow", "number": 3, "silent": True},
    ]
    places = {"x_m", "y_m", "x", "y", "heading_rad"}
    assert not places & set(game) | (places & {key for robot in game["driven"] for key in robot})


def test_a_new_game_is_told_to_the_simulation(http: httpx.Client, service: FakeService) -> None:
    service.put(records.GAME, GAME)
    before = games(service)
    assert http.post("/game").status_code == 204
    assert games(service) == before + 1


def test_in_a_match_the_score_is_public_and_a_new_game_is_not(http: httpx.Client, service: FakeService) -> None:
    service.put(records.GAME, GAME)
    assert http.patch("/match", json={"mode": "match"}).status_code == 200
    stranger = {"Authorization": "", "Cookie": ""}
    assert http.get("/game", headers=stranger).status_code == 200
    assert http.post("/game", headers=stranger).status_code == 401
