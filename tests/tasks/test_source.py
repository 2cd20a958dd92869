"""The task source hears the drivers of a simulated match, and tells the game."""

from collections.abc import Iterator
from dataclasses import replace

import pytest

from tests.tasks.stage import Stage
from vision_core.clock import after
from vision_core.rtdb import records
from vision_core.rtdb.infos import FrameRequest, LiveSettings
from vision_core.scheduling.releases import RAN, Release
from vision_core.tasks import source
from vision_core.types.drives import no_drives
from vision_core.types.game import DrivenRobot, Game
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

RATE_HZ = 50.0


class Match:
    """The task, and what the other tasks write for it."""

    def __init__(self) -> None:
        self.settings = load_settings(
            options={"camera.width_px": 320, "camera.height_px": 240, "camera.rate_hz": RATE_HZ}
        )
        self.stage = Stage(source, self.settings)
        self._requests = records.frame_requests("main").writer(self.stage.store)
        self._drives = self.stage.store.writer(records.DRIVES.name)
        self._live = records.LIVE_SETTINGS.writer(self.stage.store)
        self._number, self._began = 0, self.stage.clock.now()

    def drive(self, turn_rad_s: float) -> None:
        """Blue 2 is told to turn."""
        drives, now = no_drives(), self.stage.clock.now()
        drives[0, 1]["at"], drives[0, 1]["turn_rad_s"] = now, turn_rad_s
        self._drives.write(drives.tobytes(), now, now)

    def let_go(self) -> None:
        """The session of blue 2 ends."""
        now = self.stage.clock.now()
        self._drives.write(no_drives().tobytes(), now, now)

    def begin_game(self, games: int) -> None:
        now = self.stage.clock.now()
        self._live.write(replace(LiveSettings.of(self.settings), games=games), now, now)

    def take(self, images: int) -> Game:
        """Take images; returns the game as it is told then."""
        for _ in range(images):
            self._number += 1
            now = self.stage.clock.now()
            at = after(self._began, self._number / RATE_HZ)
            self._requests.write(FrameRequest(self._number, 0, at), now, now)
            assert self.stage.step(Release(now, now)) == RAN
        told = records.GAME.reader(self.stage.store).read(self.stage.clock.now())
        assert told is not None
        return told.value


@pytest.fixture
def match(monkeypatch: pytest.MonkeyPatch) -> Iterator[Match]:
    monkeypatch.setattr(source, "REPORT_EVERY_S", 0.0)  # with every image
    made = Match()
    yield made
    made.stage.close()


def test_a_driven_robot_is_told_until_it_is_let_go(match: Match) -> None:
    match.drive(3.0)
    assert match.take(2).driven == (DrivenRobot(Team.BLUE, 2, silent=False),)
    match.let_go()
    assert match.take(2).driven == ()


def test_the_operator_begins_a_new_game(match: Match) -> None:
    match.begin_game(7)  # the count of an earlier process of the page: no new game
    assert match.take(51).played_s == pytest.approx(1.0, abs=0.03)
    match.begin_game(8)
    assert match.take(10).played_s == pytest.approx(0.2, abs=0.03)
