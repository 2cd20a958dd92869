"""The second to fourth stage composed: a frame in, sightings out, in one compiled call.

Where robots and ball were in the last frame tells where to look: windows round them, and beside these a band that
rolls over the picture for what is new. When fewer robots are seen than of late, or no ball, the whole frame is
searched at once, in the same call.
"""

from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from vision_core.blobs.row_scan import SegmentBuffers, min_height_px, segment_buffers, segment_picture
from vision_core.clock import NS_PER_S, Clock, Instant, ManualClock
from vision_core.color.light import Lighting
from vision_core.color.lookup_table import compile_color_table, keep_classes
from vision_core.color.prefilter import prefilter_from
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_kernels import CameraMap, camera_map_from, pixel_from_field, pixels_per_square_metre
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent
from vision_core.models.from_settings import robots_of
from vision_core.native.kernels import Boxed, box, kernel, read_only
from vision_core.objects.ball.finder import BallFinder, ball_finder, find_balls
from vision_core.objects.observation import Observation
from vision_core.objects.robots.finder import RobotFinder, find_robots, robot_finder
from vision_core.patterns.geometry import width_mm
from vision_core.patterns.loader import load_pattern
from vision_core.settings.schema import Settings
from vision_core.types.image import ImageFrame
from vision_core.types.prefilter import ColorPrefilter
from vision_core.types.tables import BLOB, MAX_BALLS, MAX_ROBOTS, TEAMS, SightingsTable, Table

Row: TypeAlias = Any
"""One row of a table."""

ROBOT_M_S, BALL_M_S = 4.0, 10.0
"""Faster than these nothing moves: so large are the windows."""
MAX_GAP_S = 0.1
"""After a longer gap the whole frame is searched."""
REMEMBERED = 60
"""Frames for which a robot that vanished is searched in the whole frame."""
EXPECTED, MISSED_FOR = range(2)


class Eyes(NamedTuple):
    """All that perceiving needs beside the frame."""

    classes: Bytes
    """Of the ColorTable, shape (65536,)."""
    searched: Bytes
    """The same without the classes that nobody searches."""
    prefilter: ColorPrefilter
    camera: CameraMap
    segment: SegmentBuffers
    robots: RobotFinder
    balls: BallFinder
    heights_m: Floats
    """Of the teams' markers and the ball, shape (3,)."""
    radii_m: Floats
    """Of the teams' robots and the ball, shape (3,)."""
    windows: np.ndarray
    """Room for windows, shape (most, 4)."""
    watch: np.ndarray
    """How many robots are expected, and for how many frames fewer were seen, shape (2,)."""


@kernel
def perceive_picture(pixels: Bytes, gap_s: float, boxed: Boxed, blobs: Table, seen: Table) -> int:
    """Fill SIGHTINGS, shape (1,), which still tells of the last frame, gap_s ago; returns how many blobs there are.

    gap_s: negative for a picture that has nothing to do with the last one; boxed: Eyes.
    """
    eyes: Eyes = boxed.value
    frame, watch = seen[0], eyes.watch
    follows = 0.0 <= gap_s <= MAX_GAP_S and frame.counts[1] > 0 and frame.counts[0] >= watch[EXPECTED]
    windows = _windows(frame, gap_s, eyes) if follows else 0
    whole, count = not follows, 0
    while True:
        count = _find(pixels, windows, whole, eyes, blobs, frame)
        if whole or (frame.counts[1] > 0 and frame.counts[0] >= watch[EXPECTED]):
            break
        whole = True
    if gap_s < 0.0 or frame.counts[0] >= watch[EXPECTED] or watch[MISSED_FOR] >= REMEMBERED:
        watch[EXPECTED], watch[MISSED_FOR] = frame.counts[0], 0
    else:
        watch[MISSED_FOR] += 1
    return count


@kernel
def _find(pixels: Bytes, windows: int, whole: bool, eyes: Eyes, blobs: Table, frame: Row) -> int:
    """Search a frame; how many blobs there are."""
    count, complete = segment_picture(
        pixels, eyes.searched, eyes.prefilter, eyes.windows, windows, whole, eyes.segment, blobs
    )
    observation = Observation(blobs, count, pixels, eyes.classes, eyes.camera)
    robots = find_robots(observation, eyes.robots, frame.robots)
    balls = find_balls(observation, frame.robots, robots, eyes.balls, frame.balls)
    frame.complete, frame.counts[0], frame.counts[1] = complete, robots, balls
    return count


@kernel
def _windows(frame: Row, gap_s: float, eyes: Eyes) -> int:
    """A window round everything that the last frame showed, as far as it can have got; how many there are."""
    robots, balls = frame.counts[0], frame.counts[1]
    for k in range(robots + balls):
        if k < robots:
            kind, x_m, y_m = frame.robots[k].team, frame.robots[k].x_m, frame.robots[k].y_m
        else:
            kind, x_m, y_m = 2, frame.balls[k - robots].x_m, frame.balls[k - robots].y_m
        height_m = eyes.heights_m[kind]
        x, y = pixel_from_field(eyes.camera, x_m, y_m, height_m)
        scale = np.sqrt(pixels_per_square_metre(eyes.camera, x_m, y_m, height_m))
        reach = scale * (eyes.radii_m[kind] + gap_s * (BALL_M_S if kind == 2 else ROBOT_M_S))
        window = eyes.windows[k]
        window[0], window[1] = np.int32(x - reach), np.int32(y - reach)
        window[2], window[3] = np.int32(x + reach), np.int32(y + reach)
    everything: int = robots + balls
    return everything


class Perception:
    """Perceives the frames of one camera. Remembers of past frames only where robots and ball were.

    Raises SettingsError when a pattern file is missing or wrong, or wears colors without a class.
    """

    def __init__(self, settings: Settings, camera: CameraSetup) -> None:
        self.settings = settings
        self.camera = camera
        self.table = compile_color_table(settings.colors)
        self.lighting = Lighting(settings, camera)
        self.eyes = self._eyes()
        self.blobs: Table = np.zeros(settings.blobs.max_blobs, dtype=BLOB)
        self.blob_count = 0
        """How many of the blobs are the last frame's."""
        self.raw: Bytes = np.zeros((0, 0, 3), dtype=np.uint8)
        """The last frame."""
        self.pixels = self.raw
        """The last frame in the venue's light."""
        self._seen = SightingsTable()
        self._last = Instant(0)

    @cached_property
    def _boxed(self) -> Boxed:
        """``eyes`` as the kernels take it; settings can be checked without compiling this."""
        return box(self.eyes)

    def warm_up(self) -> None:
        """Load or compile the kernels, so that no frame waits for them."""
        dark = ImageFrame(self.camera.name, 0, Instant(0), self.camera.black_image())
        self.perceive(dark, ManualClock())
        self.lighting.warm_up()

    def perceive(self, frame: ImageFrame, clock: Clock) -> SightingsTable:
        """What a frame of the configured size shows. The table is our own: the next call overwrites it.

        A frame that is no later than the last one is judged alone.
        """
        pixels = read_only(self.lighting.lit(frame.pixels, frame.grabbed))
        gap_s = (frame.grabbed - self._last) / NS_PER_S if frame.grabbed > self._last else -1.0
        self.blob_count = perceive_picture(pixels, gap_s, self._boxed, self.blobs, self._seen.whole)
        self.raw, self.pixels, self._last = frame.pixels, pixels, frame.grabbed
        self._seen.stamp(frame.camera, frame.number, frame.grabbed, clock.now())
        return self._seen

    def _eyes(self) -> Eyes:
        settings = self.settings
        robots = robot_finder(settings, self.table)
        worn = {color for name in self._patterns() for color in (*load_pattern(name).code.colors, *_fixed(name))}
        searched = keep_classes(self.table, {*TEAMS, *worn, settings.ball.color})
        shapes = [robots_of(settings.robots, team) for team in TEAMS]
        radius = settings.ball.radius_m
        rows_apart = min_height_px(self._smallest_px(), settings.blobs.row_step)
        return Eyes(
            classes=self.table.classes,
            searched=searched.classes,
            prefilter=prefilter_from(searched),
            camera=camera_map_from(self.camera.model),
            segment=segment_buffers(*self.camera.size_px, settings.blobs, rows_apart),
            robots=robots,
            balls=ball_finder(settings, self.table),
            heights_m=np.array([*(shape.height_m for shape in shapes), radius]),
            radii_m=np.array([*(2.0**0.5 * shape.radius_m for shape in shapes), radius]),
            windows=np.zeros((MAX_ROBOTS + MAX_BALLS, 4), dtype=np.int32),
            watch=np.zeros(2, dtype=np.int64),
        )

    def _patterns(self) -> set[str]:
        return {robots_of(self.settings.robots, team).pattern for team in TEAMS}

    def _smallest_px(self) -> float:
        """Diameter of the smallest thing that is looked for, where the picture is coarsest."""
        patches = [width_mm(patch) / 1e3 for name in self._patterns() for patch in load_pattern(name).patches]
        smallest_m = min(*patches, 2.0 * self.settings.ball.radius_m)
        x, y = accepted_half_extent(self.settings.field)
        corners = np.array([(0.0, 0.0), (x, y), (x, -y), (-x, y), (-x, -y)])
        scale = np.sqrt(self.camera.model.pixels_per_square_metre(corners))
        return smallest_m * float(np.nanmin(scale))


def _fixed(name: str) -> set[str]:
    """Color classes that all robots of a pattern wear."""
    return {patch.color for patch in load_pattern(name).patches} - {"team", "code"}
