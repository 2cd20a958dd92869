"""Uses every kernel once, so that it is compiled (or loaded) before a frame waits for it."""

from collections.abc import Callable

import numpy as np

from vision_core.capture.source import open_source
from vision_core.clock import Instant, ManualClock
from vision_core.protocol.options import PAPER_OPTIONS
from vision_core.settings import Settings
from vision_core.tasks.perception import Perception
from vision_core.tasks.serving import SceneMaker
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team


def warm_up_steps(settings: Settings) -> list[tuple[str, Callable[[], None]]]:
    """What there is to compile: a name for people, and what to call."""
    return [
        ("colors, blobs and robots", lambda: Perception(settings).warm_up()),
        ("tracks and views", lambda: warm_up_scene(settings)),
        ("camera", lambda: _warm_up_synthetic(settings)),
    ]


def warm_up_scene(settings: Settings) -> None:
    """A robot of each team and a ball, seen and encoded once."""
    maker = SceneMaker(settings, Instant(0))
    ids = settings.match.blue_ids[0], settings.match.yellow_ids[0]
    robots = (
        RobotSighting(Team.BLUE, ids[0], 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.001, 0.01),
        RobotSighting(Team.YELLOW, ids[1], 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.001, 0.01),
    )
    seen = Sightings("", 1, Instant(1), Instant(1), robots, (BallSighting(0.0, 0.0, 0.3, 0.2, 1.0, 0.001),), ())
    scene = maker.scene(seen)
    maker.snapshot(scene)
    for team, number in scene.views:
        maker.datagram(scene, team, number, PAPER_OPTIONS, nul=False)


def _warm_up_synthetic(settings: Settings) -> None:
    if settings.source.uri != "synthetic":
        return
    camera = open_source(settings, ManualClock(), paced=False)
    camera.grab(np.empty((settings.camera.height_px, settings.camera.width_px, 3), dtype=np.uint8))
    camera.close()
