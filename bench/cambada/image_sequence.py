"""The frames that both architectures process: a simulated match in which ball and goals are missing at times.

In some stretches of the sequence the ball lies outside the field of view, in others walls stand in place of the goals;
the pictures themselves are not retouched. The sequence is played in a loop; where it starts again everything jumps.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import msgspec
import numpy as np

from bench.cambada.paper import RATE_HZ
from vision_core.capture.synthetic.render import Renderer
from vision_core.capture.synthetic.world import Snapshot, World
from vision_core.geometry import Bytes
from vision_core.models.camera import PinholeCamera
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import write_picture
from vision_core.settings.schema import Settings

FRAMES = 300
"""In the sequence: 15 s."""
BALL_MISSING = 100, range(60, 80)
"""Period [frames], and the frames of each period without a ball."""
GOALS_MISSING = 150, range(100, 125)
OUTSIDE_M = 3.0
"""A ball at this distance along both axes is in no picture."""


@dataclass(frozen=True, slots=True)
class LabeledFrame:
    """One frame, and what it shows."""

    pixels: Bytes
    """Shape (height, width, 3), channels blue, green, red; the next frame overwrites it."""
    scene: Snapshot
    ball: bool
    goals: bool


def labeled_frames(settings: Settings, frames: int = FRAMES) -> Iterator[LabeledFrame]:
    """Render the sequence, frame after frame. The camera of the settings must be a pinhole."""
    world, camera = World(settings), CameraSetup.from_settings(settings)
    assert isinstance(camera.model, PinholeCamera), f"camera.model = {camera.settings.model}; pinhole was expected"
    closed = msgspec.structs.replace(settings.field, goal=msgspec.structs.replace(settings.field.goal, depth_m=0.0))
    with_goals = Renderer(settings, camera, world.robots_worn)
    without = Renderer(msgspec.structs.replace(settings, field=closed), camera, world.robots_worn)
    pixels = camera.black_image()
    for number in range(frames):
        world.advance(1.0 / RATE_HZ)
        ball, goals = (number % period not in missing for period, missing in (BALL_MISSING, GOALS_MISSING))
        scene = world.snapshot()
        if not ball:
            scene = replace(scene, ball=np.array([OUTSIDE_M, OUTSIDE_M, 0.0, 0.0, 0.0, 0.0]))
        (with_goals if goals else without).draw(pixels, scene)
        yield LabeledFrame(pixels, scene, ball, goals)


def write_sequence(settings: Settings, folder: Path, frames: int = FRAMES) -> None:
    """Save the sequence as lossless pictures that sort by name, in a folder that is made."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, frame in enumerate(labeled_frames(settings, frames)):
        write_picture(folder / f"{number:04}.bmp", frame.pixels)
