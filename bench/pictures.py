"""Frames of a simulated match as a folder of pictures: a camera that can be as fast as one likes."""

import time
from pathlib import Path

import numpy as np

from bench import way
from vision_core.capture.source import open_source
from vision_core.clock import ManualClock
from vision_core.opencv import write_picture
from vision_core.rtdb.control import Attached
from vision_core.settings_files import load_settings

FRAMES = 200
ROBOTS_PER_TEAM = 11
PATIENCE_S = 60.0
LOOK_EVERY_S = 0.1


def write_match(folder: Path, rate_hz: float) -> str:
    """Render frames of a match as a camera of a rate sees it; what they are, in words.

    The folder shows them forwards, then backwards, so that nothing jumps where it begins again.
    """
    settings = load_settings(options={"synthetic.robots_per_team": ROBOTS_PER_TEAM, "camera.rate_hz": rate_hz})
    source = open_source(settings, ManualClock(), paced=False)
    camera = settings.camera
    pixels = np.empty((camera.height_px, camera.width_px, 3), dtype=np.uint8)
    for number in range(FRAMES):
        source.grab(pixels)
        write_picture(folder / f"{number:04d}.bmp", pixels)
    source.close()
    for back in range(1, FRAMES - 1):
        (folder / f"{FRAMES - 1 + back:04d}.bmp").symlink_to(f"{FRAMES - 1 - back:04d}.bmp")
    return (
        f"{FRAMES} distinct frames of {camera.width_px}x{camera.height_px} with {2 * ROBOTS_PER_TEAM} robots, looped "
        "forwards and backwards"
    )


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
