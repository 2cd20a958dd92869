"""The task contours says where the ball may be that the camera does not see."""

import os
from collections.abc import Iterator

import pytest

from vision_core.clock import MonotonicClock, after
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.rtdb.store import create_block
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle
from vision_core.scheduling.releases import IDLE, RAN, Release
from vision_core.tasks import contours
from vision_core.tasks.table import record_specs, task_table
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.regions import BallVisibility, BodyContours
from vision_core.types.tracks import BallTrack, World
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
CAMERA = CameraSetup.from_settings(SETTINGS)
BLUE = RobotSighting(Team.BLUE, 3, 0.0, 0.0, 1.2, 0.3, 0.0, 0.9, 1e-4, 0.01)
BEHIND = 1.2 + SETTINGS.robots.radius_m, 0.33
SEEN = BallSighting(0.0, 0.0, *BEHIND, 0.9, 1e-4)


class Stage:
    """The task on a real-time database, without a supervisor."""

    def __init__(self) -> None:
        tasks = {task.name: task for task in task_table(SETTINGS)}
        specs = record_specs(SETTINGS, tuple(tasks.values()), tuple(tasks))
        self.block = create_block(specs)
        self.clock = MonotonicClock()
        attachment = Attachment(ChildResources("follow", os.getpid(), 0, self.block, specs, None, {}, {}))
        self.store = attachment.store
        self.step = contours.start(Handle(tasks["contours"], attachment, SETTINGS, CAMERA))
        self._sightings = records.sightings("main").writer(self.store)
        self._world = records.WORLD.writer(self.store)
        self._number = 0

    def see(self, *balls: BallSighting, robots: tuple[RobotSighting, ...] = (BLUE,)) -> None:
        now = self.clock.now()
        self._number += 1
        seen = Sightings("main", self._number, now, now, robots, balls, True)
        self._sightings.write(seen, now, now)

    def track(self, place: tuple[float, float] | None) -> None:
        now = self.clock.now()
        ball = place and BallTrack(*place, 0.0, 0.0, 0.01, True, after(now, -0.1))
        self._world.write(World(self._number, now, (), ball, ()), now, now)

    def found(self) -> BodyContours:
        assert self.step(Release(self.clock.now(), self.clock.now())) is RAN
        timed = records.contours("main").reader(self.store).read(self.clock.now())
        assert timed is not None
        return timed.value.found


@pytest.fixture
def stage() -> Iterator[Stage]:
    made = Stage()
    yield made
    os.close(made.block)


def test_it_waits_for_sightings_and_judges_each_once(stage: Stage) -> None:
    release = Release(stage.clock.now(), stage.clock.now())
    assert stage.step(release) is IDLE
    stage.see()
    assert stage.found().ball is BallVisibility.UNKNOWN
    assert stage.step(release) is IDLE


def test_a_ball_that_is_seen(stage: Stage) -> None:
    stage.see(SEEN)
    stage.track(BEHIND)
    found = stage.found()
    assert found.ball is BallVisibility.SEEN
    (body,) = found.bodies
    assert (body.team, body.id) == (Team.BLUE, 3)
    assert len(body.outline_px) == len(body.outline_m)


def test_a_ball_behind_a_robot_may_be_hidden_and_elsewhere_is_gone(stage: Stage) -> None:
    stage.see()
    stage.track(BEHIND)
    found = stage.found()
    assert found.ball is BallVisibility.MAY_BE_HIDDEN
    assert found.hiding == ((Team.BLUE, 3),)
    stage.see()
    stage.track((-0.5, 0.0))
    found = stage.found()
    assert found.ball is BallVisibility.GONE
    assert found.hiding == ()


def test_where_the_ball_was_is_remembered_when_its_track_has_ended(stage: Stage) -> None:
    stage.see()
    stage.track((-0.5, 0.0))
    stage.found()
    stage.see()
    stage.track(None)
    assert stage.found().ball is BallVisibility.GONE
    stage.see()
    stage.track((9.0, 0.0))
    assert stage.found().ball is BallVisibility.OUT_OF_PICTURE
