"""A folder of pictures as a camera of any rate: frames of a simulated match, rendered beforehand.

The simulated camera renders each frame when it is due and cannot deliver 200 frames per second; a folder that the
service has read once can.
"""

import contextlib
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from bench import frame_path
from bench.service import RunningService, attached_service
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
TIMEOUT_S = 60.0
POLL_EVERY_S = 0.1


def render_match(rate_hz: float, robots_per_team: int = ROBOTS_PER_TEAM) -> tuple[Settings, list[Bytes]]:
    """Settings of a match in which all 22 robots may connect, and its frames as a camera of a rate sees them."""
    shown = {"synthetic.robots_per_team": robots_per_team, "camera.rate_hz": rate_hz}
    settings = load_settings(options=shown | {"match.numbers": ROBOTS_PER_TEAM})
    camera = CameraSetup.from_settings(settings)
    source = open_source(settings, camera, ManualClock(), paced=False)
    frames = []
    for _ in range(FRAMES):
        pixels = camera.black_image()
        source.grab(pixels)
        frames.append(pixels)
    source.close()
    return settings, frames


def playback_order() -> list[int]:
    """Numbers of the frames in the order of playback: forwards, then backwards, so that nothing jumps in a loop."""
    return [*range(FRAMES), *range(FRAMES - 2, 0, -1)]


def description_of(settings: Settings) -> str:
    """The frames of ``render_match`` in words, for a benchmark's table."""
    width, height = CameraSetup.from_settings(settings).size_px
    robots = 2 * settings.synthetic.robots_per_team
    return f"{FRAMES} distinct frames of {width}x{height} with {robots} robots, looped forwards and backwards"


@contextlib.contextmanager
def match_service(
    rate_hz: float, robots_per_team: int = ROBOTS_PER_TEAM, further: str = ""
) -> Iterator[tuple[RunningService, Attached, str]]:
    """A running service that shows a match at a rate, all frames in its memory; its database; the frames in words.

    further: the text of further settings.
    """
    with tempfile.TemporaryDirectory(prefix="pslv-bench-") as name:
        description = _write_match(Path(name), rate_hz, robots_per_team)
        settings = f"camera.rate_hz = {rate_hz}\nmatch.numbers = {ROBOTS_PER_TEAM}\n{further}"
        with attached_service(settings, "--source", f"file:{name}") as (service, attached):
            _wait_until_all_are_loaded(attached)
            yield service, attached, description


def _write_match(folder: Path, rate_hz: float, robots_per_team: int) -> str:
    """Write a match's frames into a folder, in the order of playback. Returns them in words."""
    settings, frames = render_match(rate_hz, robots_per_team)
    for place, number in enumerate(playback_order()):
        if place == number:
            write_picture(folder / f"{number:04d}.bmp", frames[number])
        else:
            (folder / f"{place:04d}.bmp").symlink_to(f"{number:04d}.bmp")
    return description_of(settings)


def _wait_until_all_are_loaded(attached: Attached) -> None:
    """Wait until the service has shown every picture, so that all are in its memory. Raises RuntimeError."""
    frames = attached.store.reader(frame_path.FRAMES)
    first, deadline = frames.sequence, time.monotonic() + TIMEOUT_S
    while frames.sequence - first < 2 * FRAMES:
        if time.monotonic() > deadline:
            raise RuntimeError(f"{frames.sequence - first} frames within {TIMEOUT_S:g} s; {2 * FRAMES} were expected")
        time.sleep(POLL_EVERY_S)
