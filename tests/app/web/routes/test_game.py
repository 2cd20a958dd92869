"""The score of a simulated match over the API, and a new game."""

import httpx

from tests.app.fake_service import GAME, FakeService
from vision_core.rtdb import records


def games(service: FakeService) -> int:
    reading = records.LIVE_SETTINGS.reader(service.store).read(service.clock.now())
    return reading.value.games if reading else 0


def test_a_match_that_is_not_simulated_has_no_score(operator: httpx.Client) -> None:
    for answer in (operator.get("/game"), operator.post("/game")):
        assert answer.status_code == 404
        assert answer.json()["accepted"] == "a simulated match that has begun: pslv serve without a camera"


def test_the_score_and_who_drives(operator: httpx.Client, service: FakeService) -> None:
    service.put(records.GAME, GAME)
    game = operator.get("/game").json()
    assert (game["blue"], game["yellow"]["goals"], game["owner"]) == ({"goals": 2, "possession_s": 90.0}, 1, "blue")
    assert game["driven"] == [
        {"team": "blue", "number": 1, "silent": False},
        {"team": "yellow", "number": 3, "silent": True},
    ]
    places = {"x_m", "y_m", "x", "y", "heading_rad"}
    assert not places & set(game) | (places & {key for robot in game["driven"] for key in robot})


def test_a_new_game_is_told_to_the_simulation(operator: httpx.Client, service: FakeService) -> None:
    service.put(records.GAME, GAME)
    before = games(service)
    assert operator.post("/game").status_code == 204
    assert games(service) == before + 1


def test_in_a_match_the_score_is_public_and_a_new_game_is_not(operator: httpx.Client, service: FakeService) -> None:
    service.put(records.GAME, GAME)
    assert operator.patch("/match", json={"mode": "match"}).status_code == 200
    stranger = {"Authorization": "", "Cookie": ""}
    assert operator.get("/game", headers=stranger).status_code == 200
    assert operator.post("/game", headers=stranger).status_code == 401
