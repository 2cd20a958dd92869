"""A match: players against a server, a page that tells the score, and a picture."""

import os
from collections.abc import Iterator
from xml.etree import ElementTree as ET

import pytest

from tests.client.arena import Arena
from tests.client.play.service_page import ServicePage, served
from tests.net.serving import playing
from vision_core.client import Drive, Robot, View
from vision_core.client.play.chart import chart
from vision_core.client.play.game import Page, Score
from vision_core.client.play.match import play, service_cpu_s
from vision_core.client.play.players import Player, PlayerCount, Server
from vision_core.errors import ConnectionRefused, ServiceError
from vision_core.types.objects import Team


class Ahead:
    """Drives straight on."""

    def __init__(self, robot: Robot) -> None: ...

    def decide(self, view: View) -> Drive:
        return Drive(0.5)


class Careless(Ahead):
    def decide(self, view: View) -> Drive:
        raise ZeroDivisionError("of the controller")


@pytest.fixture
def page() -> Iterator[Page]:
    with served() as address:
        yield Page(address)


@pytest.fixture
def arena() -> Iterator[Arena]:
    with playing(Arena()) as opened:
        yield opened


def test_players_see_drive_and_are_counted(arena: Arena, page: Page) -> None:
    server = Server("127.0.0.1", arena.port)
    players = [Player(server, team, 1, Ahead) for team in Team]
    shown: list[Score] = []
    match = play(players, page, 1.2, lambda _, score: shown.append(score))
    assert {event.session.team for event in arena.driven} == set(Team)
    assert all(event.drive == Drive(0.5) for event in arena.driven)
    assert all(player.count.views > 3 for player in match.players)
    assert match.controllers_cpu_s > 0.0
    assert match.service_cpu_s is not None
    assert shown[0] == match.scores[0] == Score(0.0, (0, 0), (0.0, 0.0), 0)
    assert (match.final.played_s, match.final.collisions) == (len(match.scores) - 1, len(match.scores) - 1)
    assert match.final.blue_share == pytest.approx(0.25)


def test_a_controller_that_fails_ends_the_match(arena: Arena, page: Page) -> None:
    players = [
        Player(Server("127.0.0.1", arena.port), Team.BLUE, number, kind) for number, kind in ((1, Ahead), (2, Careless))
    ]
    with pytest.raises(ZeroDivisionError, match="of the controller"):
        play(players, page, 30.0, lambda *_: None)


def test_a_robot_that_no_program_drives_is_refused(arena: Arena, page: Page) -> None:
    with pytest.raises(ConnectionRefused, match="drive blue 5 .*no_drive"):
        play([Player(Server("127.0.0.1", arena.port), Team.BLUE, 5, Ahead)], page, 30.0, lambda *_: None)


def test_a_page_without_a_game_is_named(page: Page) -> None:
    ServicePage.code = 404
    with pytest.raises(ServiceError, match="/api/v1/game; found: 404 no game; accepted: a simulated match"):
        page.score()
    with pytest.raises(ServiceError, match="accepted: the page of a service that runs: pslv serve"):
        Page("http://127.0.0.1:9").score()


def test_a_game_that_begins_anew_counts_from_its_beginning() -> None:
    earlier, later = Score(100.0, (3, 4), (50.0, 50.0), 90), Score(2.0, (1, 0), (2.0, 0.0), 1)
    assert later.since(earlier) == later
    assert later.collisions_per_minute == 30.0
    assert Score(0.0, (0, 0), (0.0, 0.0), 0).blue_share == 0.5


def test_processor_time_of_processes_that_are_here() -> None:
    assert service_cpu_s(()) is None
    assert service_cpu_s((2**30,)) is None
    assert (service_cpu_s((os.getpid(),)) or 0.0) > 0.0


def test_counts_of_a_player() -> None:
    count = PlayerCount(views=30, missed=10, age_s=1.5)
    assert (count.missed_share, count.mean_age_ms) == (0.25, 50.0)
    assert (PlayerCount().missed_share, PlayerCount().mean_age_ms) == (0.0, 0.0)


@pytest.mark.parametrize("seconds", [1, 40, 300])
def test_the_picture_is_one_and_shows_the_score(seconds: int) -> None:
    scores = [Score(float(i), (i // 20, i // 30), (0.6 * i, 0.4 * i), i // 2) for i in range(seconds)]
    picture = ET.fromstring(chart("ours & <theirs>", scores))
    texts = [element.text for element in picture.iter("{http://www.w3.org/2000/svg}text")]
    assert texts[0] == "ours & <theirs>"
    assert f"blue {scores[-1].goals[0]:.3g}" in texts
    lines = list(picture.iter("{http://www.w3.org/2000/svg}polyline"))
    assert [len(line.attrib["points"].split()) for line in lines] == [seconds] * 5
    heights = [float(point.split(",")[1]) for line in lines for point in line.attrib["points"].split()]
    assert 0.0 < min(heights) <= max(heights) < float(picture.attrib["height"])
