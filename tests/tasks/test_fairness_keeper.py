"""The record of fairness across a restart of the process that counts, and across the end of a match."""

import os
from collections.abc import Iterator

import pytest
from msgspec.structs import replace

from tests.app.fake_service import FakeService, Scene
from vision_core.clock import Instant
from vision_core.models.camera_setup import CameraSetup
from vision_core.net.fairness import FairnessRecord
from vision_core.rtdb import records
from vision_core.rtdb.infos import LiveSettings
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle
from vision_core.settings.schema import MatchSettings
from vision_core.tasks.fairness_keeper import FairnessKeeper
from vision_core.types.fairness import MATCH, fairness_from
from vision_core.types.tables import Table


class Rig:
    """The record of one service, and processes that count one after the other."""

    def __init__(self, service: FakeService) -> None:
        self.service = service

    def start(self) -> tuple[FairnessKeeper, FairnessRecord]:
        """A new process."""
        service = self.service
        attachment = Attachment(
            ChildResources("serve", os.getpid(), service.boot, service.block, service.specs, None, {}, {})
        )
        (task,) = (task for task in service.tasks if task.name == "serve")
        handle = Handle(task, attachment, service.settings, CameraSetup.from_settings(service.settings))
        record = FairnessRecord(service.boot)
        return FairnessKeeper(handle, record), record

    def live(self, **match: object) -> LiveSettings:
        """What the page publishes."""
        changed: MatchSettings = replace(self.service.settings.match, **match)
        return LiveSettings.of(replace(self.service.settings, match=changed))

    def read(self, name: str) -> Table | None:
        """A record of the database."""
        reading = self.service.store.reader(name).read(self.service.clock.now())
        return None if reading is None else fairness_from(reading.value)[0]


@pytest.fixture
def rig() -> Iterator[Rig]:
    service = FakeService(Scene(clients=0))
    yield Rig(service)
    service.stop()


def test_a_successor_goes_on_with_the_match_that_its_files_do_not_know(rig: Rig) -> None:
    keeper, record = rig.start()
    match = rig.live(mode="match", blue_name="Graz")
    keeper.follow(match)
    record.table["frames"][0, 4] = 123
    keeper.publish(rig.service.clock.now())
    successor, again = rig.start()
    successor.follow(match)
    assert again.table["frames"][0, 4] == 123
    assert again.table["seed"] == record.table["seed"]
    assert again.table["reason"] == MATCH
    assert rig.read(records.FAIRNESS_ENDED.name) is None


def test_the_end_of_a_match_is_told_at_once(rig: Rig) -> None:
    keeper, record = rig.start()
    keeper.follow(rig.live(mode="match", blue_name="Graz"))
    record.table["frames"][0, 4] = 123
    keeper.publish(Instant(1))
    keeper.follow(rig.live(mode="practice"))
    keeper.publish(Instant(2))
    ended, running = rig.read(records.FAIRNESS_ENDED.name), rig.read(records.FAIRNESS_RECORD.name)
    assert ended is not None
    assert running is not None
    assert ended["frames"][4] == 123
    assert ended["blue_name"] == b"Graz"
    assert ended["ended_s"] >= ended["began_s"]
    assert running["frames"].sum() == 0
    assert running["ended_s"] == 0.0
