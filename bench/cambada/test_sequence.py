"""The frames that both arms of the experiment look at: a simulated match, in which things are sometimes gone.

The ball really leaves the scene, and the goals are built over with wall, each for stretches of the sequence; nothing is
painted over in the picture. The sequence is played over and over: at its beginning everything jumps once.
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
"""Of the sequence, 15 s."""
BALL_GONE = 100, range(60, 80)
"""Of every so many frames, those without it."""
GOALS_GONE = 150, range(100, 125)
AWAY_M = 3.0
"""A ball that lies so far away, along both axes, is in no picture."""


@dataclass(frozen=True, slots=True)
class Shot:
    """One frame, and what is in it."""

    pixels: Bytes
    """Shape (height, width, 3), blue green red; the sequence's own memory, filled anew for each frame."""
    scene: Snapshot
    ball: bool
    goals: bool


def shots(settings: Settings, frames: int = FRAMES) -> Iterator[Shot]:
    """Render the sequence, frame after frame. The camera of the settings must be a lens."""
    world, camera = World(settings), CameraSetup.from_settings(settings)
    assert isinstance(camera.model, PinholeCamera), f"camera.model = {camera.settings.model}, not pinhole"
    closed = msgspec.structs.replace(settings.field, goal=msgspec.structs.replace(settings.field.goal, depth_m=0.0))
    with_goals = Renderer(settings, camera, world.robots_worn)
    without = Renderer(msgspec.structs.replace(settings, field=closed), camera, world.robots_worn)
    pixels = camera.black_image()
    for number in range(frames):
        world.advance(1.0 / RATE_HZ)
        ball, goals = (number % every not in gone for every, gone in (BALL_GONE, GOALS_GONE))
        scene = world.snapshot()
        if not ball:
            scene = replace(scene, ball=np.array([AWAY_M, AWAY_M, 0.0, 0.0, 0.0, 0.0]))
        (with_goals if goals else without).draw(pixels, scene)
        yield Shot(pixels, scene, ball, goals)


def write_sequence(settings: Settings, folder: Path, frames: int = FRAMES) -> None:
    """Save the sequence as pictures without loss, named so that they sort. The folder is made."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, shot in enumerate(shots(settings, frames)):
        write_picture(folder / f"{number:04}.bmp", shot.pixels)
