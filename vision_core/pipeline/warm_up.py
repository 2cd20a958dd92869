"""Uses every kernel once, so that it is compiled (or loaded) before a frame waits for it."""

import sys

import msgspec
import numpy as np

from vision_core.capture.source import open_source
from vision_core.clock import Instant, ManualClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.net.delivery import Batch, DeliveryTable
from vision_core.pipeline.diagnosis import reasons_of
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.view_encoder import Messages
from vision_core.scheduling.attachment import end_with
from vision_core.settings.schema import Settings
from vision_core.tracks.tracker import Tracker
from vision_core.types.image import ImageFrame
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.tables import SightingsTable, obstacle_table


def perception(settings: Settings) -> None:
    """An empty picture, and why nothing is seen in a meaningless one."""
    setup = CameraSetup.from_settings(settings)
    eyes = Perception(settings, setup)
    eyes.warm_up()
    noise = np.random.default_rng(1).integers(0, 255, setup.shape, dtype=np.uint8)
    seen = eyes.perceive(ImageFrame(setup.name, 1, Instant(0), noise), ManualClock()).record()
    reasons_of(eyes, seen)


def views(settings: Settings) -> None:
    """A robot of each team and a ball, seen and encoded once."""
    ids = settings.match.blue_ids[0], settings.match.yellow_ids[0]
    robots = (
        RobotSighting(Team.BLUE, ids[0], 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.001, 0.01),
        RobotSighting(Team.YELLOW, ids[1], 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.001, 0.01),
    )
    seen = Sightings("", 1, Instant(1), Instant(1), robots, (BallSighting(0.0, 0.0, 0.3, 0.2, 1.0, 0.001),), True)
    world = Tracker(settings.tracks, settings.robots).update(SightingsTable.of(seen), obstacle_table(()))
    messages, deliveries = Messages(settings, Instant(0)), DeliveryTable(Instant(0))
    messages.write(world, ())
    deliveries.due(Instant(1))
    deliveries.send(Instant(1), Batch.of(()))


def camera(settings: Settings) -> None:
    """A simulated picture, where one is asked for."""
    if settings.source.uri != "synthetic":
        return
    source = open_source(settings, CameraSetup.from_settings(settings), ManualClock(), paced=False)
    source.grab(CameraSetup.from_settings(settings).black_image())
    source.close()


def main() -> None:
    """Compile one step; its name and the compiler's process id are the arguments, the settings come as JSON."""
    end_with(int(sys.argv[2]))
    settings = msgspec.json.decode(sys.stdin.buffer.read(), type=Settings)
    {"perception": perception, "views": views, "camera": camera}[sys.argv[1]](settings)


if __name__ == "__main__":
    main()
