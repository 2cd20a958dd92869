"""Frames of a simulated match as a folder of pictures: a camera that can be as fast as one likes."""

import time
from pathlib import Path

from bench import frame_path as way
from vision_core.capture.source import open_source
from vision_core.clock import ManualClock
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import write_picture
from vision_core.net.control import Attached
from vision_core.settings.schema import Settings
from vision_core.venues.loader import load_settings

FRAMES = 200
ROBOTS_PER_TEAM = 11
PATIENCE_S = 60.0
LOOK_EVERY_S = 0.1


def match(rate_hz: float, robots_per_team: int = ROBOTS_PER_TEAM) -> tuple[Settings, list[Bytes]]:
    """Settings of a match in which all robots may connect, and frames of it as a camera of a rate sees them."""
    shown = {"synthetic.robots_per_team": robots_per_team, "camera.rate_hz": rate_hz}
    settings = load_settings(options=shown | {"match.numbers": ROBOTS_PER_TEAM})
    source = open_source(settings, CameraSetup.from_settings(settings), ManualClock(), paced=False)
    frames = []
    for _ in range(FRAMES):
        pixels = CameraSetup.from_settings(settings).black_image()
        source.grab(pixels)
        frames.append(pixels)
    source.close()
    return settings, frames


def forwards_and_backwards() -> list[int]:
    """The order in which frames are shown, so that nothing jumps where they begin again."""
    return [*range(FRAMES), *range(FRAMES - 2, 0, -1)]


def write_match(folder: Path, rate_hz: float) -> str:
    """Frames of a match as files, in the order in which they are shown; what they are, in words."""
    settings, frames = match(rate_hz)
    for place, number in enumerate(forwards_and_backwards()):
        if place == number:
            write_picture(folder / f"{number:04d}.bmp", frames[number])
        else:
            (folder / f"{place:04d}.bmp").symlink_to(f"{number:04d}.bmp")
    return in_words(settings)


def in_words(settings: Settings) -> str:
    """What a benchmark shows."""
    size = f"{settings.camera.width_px}x{settings.camera.height_px}"
    robots = 2 * settings.synthetic.robots_per_team
    return f"{FRAMES} distinct frames of {size} with {robots} robots, looped forwards and backwards"


def wait_for_all(attached: Attached) -> None:
    """Wait until the service has shown the folder once, and has it in memory. Raises RuntimeError when it does not."""
    frames = attached.store.reader(way.FRAMES)
    begun, deadline = frames.sequence, time.monotonic() + PATIENCE_S
    while frames.sequence - begun < 2 * FRAMES:
        if time.monotonic() > deadline:
            raise RuntimeError(f"{frames.sequence - begun} frames within {PATIENCE_S:g} s; {2 * FRAMES} were expected")
        time.sleep(LOOK_EVERY_S)


def config_of(rate_hz: float) -> str:
    """The service's settings for such a folder: all robots may connect."""
    return f"camera.rate_hz = {rate_hz}\nmatch.numbers = {ROBOTS_PER_TEAM}\n"
