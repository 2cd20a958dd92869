"""Uses every kernel of the service once, so that it is compiled (or loaded from disk) before a frame waits for it.

As a process this module compiles: its first line of standard input is the settings as JSON, each further line is the
name of a step; it answers with the name when the step is done. The steps are listed in ``startup.compile``.
"""

import sys

import msgspec
import numpy as np

from vision_core.blobs.row_scan import segment_picture
from vision_core.capture.source import open_source
from vision_core.clock import Instant, ManualClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.kernels import box, compile_for_kernels, field_type, read_only
from vision_core.net.delivery import Batch, DeliveryTable
from vision_core.objects.ball.finder import find_balls
from vision_core.objects.observation import Observation
from vision_core.objects.robots.finder import find_robots
from vision_core.objects.robots.verification import verify_robots
from vision_core.pipeline.diagnosis import reasons_of
from vision_core.pipeline.overlay import OverlayMaker
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.suggestions import NOTHING
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.scheduling.attachment import end_with
from vision_core.settings.schema import SYNTHETIC, Settings
from vision_core.tracks.tracker import Tracker
from vision_core.types.image import ImageFrame
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.overlay import Layer
from vision_core.types.tables import SightingsTable, Table, WorldTable, obstacle_table


def perception(settings: Settings) -> None:
    """Perceive an empty picture, explain why nothing is seen in noise, and draw what is."""
    setup = CameraSetup.from_settings(settings)
    stage = Perception(settings, setup)
    stage.warm_up()
    noise = np.random.default_rng(1).integers(0, 255, setup.shape, dtype=np.uint8)
    frame = ImageFrame(setup.name, 1, Instant(0), noise)
    seen = stage.perceive(frame, ManualClock()).record()
    reasons_of(stage, seen)
    OverlayMaker(stage).make(frame, (Layer.HYPOTHESES,), ManualClock())


def views(settings: Settings) -> None:
    """Track a robot of each team and a ball, render what they see, encode it and send it to no client."""
    encode(settings, track(settings))


def track(settings: Settings) -> WorldTable:
    """Track a robot of each team and a ball; returns the world."""
    ids = settings.match.blue_ids[0], settings.match.yellow_ids[0]
    robots = (
        RobotSighting(Team.BLUE, ids[0], 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.001, 0.01),
        RobotSighting(Team.YELLOW, ids[1], 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.001, 0.01),
    )
    seen = Sightings("", 1, Instant(1), Instant(1), robots, (BallSighting(0.0, 0.0, 0.3, 0.2, 1.0, 0.001),), True)
    return Tracker(settings.tracks, settings.robots).update(SightingsTable.of(seen), obstacle_table(()))


def encode(settings: Settings, world: WorldTable) -> None:
    """Render and encode the views of a world, and send them to no client."""
    encoder, deliveries = ViewEncoder(settings, Instant(0)), DeliveryTable(Instant(0))
    encoder.write(world, ())
    deliveries.due(Instant(1))
    deliveries.send(Instant(1), Batch.of(()))


def camera(settings: Settings) -> None:
    """Make a simulated picture, if the settings ask for a simulated camera."""
    if settings.source.uri != SYNTHETIC:
        return
    setup = CameraSetup.from_settings(settings)
    source = open_source(settings, setup, ManualClock(), paced=False)
    source.grab(setup.black_image())
    source.close()


def compile_blobs(settings: Settings) -> None:
    """Compile the segmentation for ``perceive_picture``, and what judges the light."""
    stage, seen, _ = _finder_inputs(settings)
    stage.lighting.warm_up()
    context = stage.context
    compile_for_kernels(
        segment_picture,
        seen.pixels,
        context.searched,
        context.prefilter,
        context.windows,
        0,
        False,
        context.segment,
        seen.blobs,
    )


def compile_robots(settings: Settings) -> None:
    """Compile the finder of robots for ``perceive_picture``."""
    stage, seen, sightings = _finder_inputs(settings)
    compile_for_kernels(find_robots, seen, stage.context.robots, 0, field_type(sightings, "robots"))


def compile_verification(settings: Settings) -> None:
    """Compile what verifies known robots for ``perceive_picture``."""
    stage, seen, _ = _finder_inputs(settings)
    compile_for_kernels(verify_robots, seen, stage.context.robots, stage.context.held)


def compile_balls(settings: Settings) -> None:
    """Compile the finder of balls for ``perceive_picture``."""
    stage, seen, sightings = _finder_inputs(settings)
    robots, balls = field_type(sightings, "robots"), field_type(sightings, "balls")
    compile_for_kernels(find_balls, seen, robots, 0, stage.context.balls, balls)


def box_arguments(settings: Settings) -> None:
    """Compile what takes the arguments of ``perceive_picture`` apart."""
    box(Perception(settings, CameraSetup.from_settings(settings)).context)


def confirm(settings: Settings) -> None:
    """Look for robots by their shapes in an empty picture."""
    setup = CameraSetup.from_settings(settings)
    stage = Perception(settings, setup)
    stage.pixels = read_only(setup.black_image())
    stage.confirm(NOTHING)


def perceive(settings: Settings) -> None:
    """Perceive an empty picture."""
    setup = CameraSetup.from_settings(settings)
    frame = ImageFrame(setup.name, 1, Instant(0), setup.black_image())
    Perception(settings, setup).perceive(frame, ManualClock())


def _finder_inputs(settings: Settings) -> tuple[Perception, Observation, Table]:
    """The arguments of the finders: the perception stage, the observation of an empty picture, an empty table."""
    setup = CameraSetup.from_settings(settings)
    stage = Perception(settings, setup)
    seen = Observation(stage.blobs, 0, read_only(setup.black_image()), stage.context.classes, stage.context.camera)
    return stage, seen, SightingsTable().whole


COMPILERS = {
    "robots": compile_robots,
    "blobs": compile_blobs,
    "verification": compile_verification,
    "balls": compile_balls,
    "arguments": box_arguments,
    "confirmation": confirm,
    "perception": perceive,
    "diagnosis": perception,
    "tracks": track,
    "views": lambda settings: encode(settings, WorldTable()),
    "camera": camera,
}
"""What each step of ``startup.compile`` does."""


def main() -> None:
    """Compile the steps that standard input names. The argument is the process id of the parent."""
    end_with(int(sys.argv[1]))
    settings = msgspec.json.decode(sys.stdin.buffer.readline(), type=Settings)
    for line in sys.stdin:
        COMPILERS[line.strip()](settings)
        print(line.strip(), flush=True)


if __name__ == "__main__":
    main()
