"""The second to fourth stage combined: a frame in, sightings out, in one compiled call.

Robots that were read in the last frame are verified where they should be now. The rest of that frame tells where to
search: in windows around the other robots and the ball, and in a band of rows that moves over the picture, so that new
objects are found. When fewer robots than expected are found, or no ball, the whole frame is searched at once, in the
same call.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from vision_core.blobs.bits import bits_of
from vision_core.blobs.row_scan import SegmentBuffers, min_height_px, segment_buffers, segment_picture
from vision_core.clock import NS_PER_S, Clock, Instant, ManualClock
from vision_core.color.light import Lighting
from vision_core.color.lookup_table import compile_color_table, keep_classes
from vision_core.color.prefilter import prefilter_from
from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.camera_kernels import CameraMap, camera_map_from, pixel_from_field, pixels_per_square_metre
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent
from vision_core.models.from_settings import robots_of
from vision_core.models.mirror import MM_PER_M
from vision_core.native.kernels import Boxed, box, kernel, read_only
from vision_core.native.rewind import Rewind
from vision_core.objects.ball.finder import BallFinder, ball_finder, find_balls
from vision_core.objects.observation import Observation
from vision_core.objects.robots.confirmation import confirm_robots
from vision_core.objects.robots.confirmation_buffers import shapes_from
from vision_core.objects.robots.finder import RobotFinder, find_robots, robot_finder
from vision_core.objects.robots.held import NO_ROW, HeldRobots, held_robots, hold_read, move_robots, row_of
from vision_core.objects.robots.verification import verify_robots
from vision_core.patterns.geometry import width_mm
from vision_core.patterns.pattern import CODE, TEAM, Pattern
from vision_core.patterns.worn import worn_patterns
from vision_core.pipeline.suggestions import NOTHING, ShapeSearch, Suggestions
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable, References
from vision_core.types.image import ImageFrame
from vision_core.types.prefilter import CONDITIONS, ColorPrefilter
from vision_core.types.tables import BLOB, MAX_BALLS, MAX_ROBOTS, TEAMS, SightingsTable, Table

Row: TypeAlias = Any
"""One row of a table in a kernel: its fields are attributes."""

MAX_ROBOT_M_S = 4.0
"""Highest speed: it determines the size of the windows around robots."""
BALL_MARGIN_M, BALL_CHANGE = 0.04, 0.5
"""How far a ball may be off the place where its speed takes it, and by which share of its way in addition. A ball that
is kicked leaves its window, and the whole frame is searched for it."""
MAX_GAP_S = 0.1
"""After a longer gap the whole frame is searched."""
ALONE = -1.0
"""Gap before a picture without relation to the last one [s]."""
MAX_MISSED_FRAMES = 60
"""Frames for which a robot that vanished is still expected, and so searched in the whole frame."""
BALL_KIND = 2
"""Index of the ball in ``heights_m`` and ``radii_m``; 0 and 1 are the teams."""

EXPECTED = np.dtype([("robots", np.int64), ("missed_frames", np.int64)])
"""How many robots are expected in a frame, and in how many frames in a row fewer were found."""

FOLLOWED_BALL = np.dtype([(name, np.float64) for name in ("x_m", "y_m", "x_m_s", "y_m_s")])
"""The first ball of the last frame, and its speed; nan: there was none."""


class PerceptionContext(NamedTuple):
    """Arguments of ``perceive_picture`` that stay the same from frame to frame, and its memory."""

    classes: Bytes
    """Of the ColorTable, shape (65536,)."""
    searched: Bytes
    """The same without the classes that neither a robot nor the ball has."""
    prefilter: ColorPrefilter
    camera: CameraMap
    segment: SegmentBuffers
    robots: RobotFinder
    held: HeldRobots
    balls: BallFinder
    heights_m: Floats
    """Of the markers of blue, of yellow, and of the ball, shape (3,)."""
    radii_m: Floats
    """Of the robots of blue, of yellow (of a square: of its corners), and of the ball, shape (3,)."""
    windows: np.ndarray
    """Scratch: left, top, right, bottom of each window [px], shape (MAX_ROBOTS + MAX_BALLS, 4)."""
    expected: Table
    """EXPECTED, shape (1,)."""
    ball: Table
    """FOLLOWED_BALL, shape (1,)."""


@kernel
def perceive_picture(pixels: Bytes, gap_s: float, boxed: Boxed, blobs: Table, seen: Table) -> tuple[int, bool]:
    """Replace the sightings of the last frame, gap_s ago, by those of this one.

    Returns the number of blobs, and whether a robot of the last frames is missing. gap_s: negative for a picture
    without relation to the last one; boxed: PerceptionContext; blobs: output, BLOB, shape (n,); seen: SIGHTINGS,
    shape (1,).
    """
    context: PerceptionContext = boxed.value
    frame, expected = seen[0], context.expected[0]
    move_robots(context.held, gap_s)
    known = int(np.int64(0))
    is_next = 0.0 <= gap_s <= MAX_GAP_S
    if is_next:
        observation = Observation(blobs, 0, pixels, context.classes, context.camera)
        known = verify_robots(observation, context.robots, context.held)
    # Windows only after a complete frame, a short time ago.
    follows = is_next and frame.counts[1] > 0 and frame.counts[0] >= expected.robots
    windows = _place_windows(frame, known, gap_s, context) if follows else 0
    whole, count = not follows, 0
    while True:
        count = _find(pixels, known, windows, whole, context, blobs, frame)
        if whole or (frame.counts[1] > 0 and frame.counts[0] >= expected.robots):
            break
        whole = True
    # Expect as many robots as there are now; fewer only after they were missing for a while.
    if gap_s < 0.0 or frame.counts[0] >= expected.robots or expected.missed_frames >= MAX_MISSED_FRAMES:
        expected.robots, expected.missed_frames = frame.counts[0], 0
    else:
        expected.missed_frames += 1
    _follow_ball(context.ball[0], frame, gap_s)
    return count, hold_read(context.held, gap_s, frame.robots, frame.counts[0])


@kernel
def confirm_picture(
    pixels: Bytes, gap_s: float, boxed: Boxed, shapes: Boxed, blobs: Table, seen: Table
) -> None:  # fmt: skip
    """Add the robots to a frame's sightings that their shape shows, where one is missing or suggested.

    It is seldom called; within ``perceive_picture`` it would take long to compile. shapes: Shapes; the other arguments
    are those of ``perceive_picture``, which was called before.
    """
    context: PerceptionContext = boxed.value
    frame = seen[0]
    observation = Observation(blobs, 0, pixels, context.classes, context.camera)
    frame.counts[0] = confirm_robots(
        observation, context.robots, shapes.value, context.held, frame.robots, frame.counts[0]
    )  # fmt: skip
    hold_read(context.held, gap_s, frame.robots, frame.counts[0])


@kernel
def _find(
    pixels: Bytes, known: int, windows: int, whole: bool, context: PerceptionContext, blobs: Table, frame: Row
) -> int:  # fmt: skip
    """Search a frame, in its first windows and the band, or whole; returns the number of blobs.

    known: how many robots are verified; their blobs are left out.
    """
    count, complete = segment_picture(
        pixels, context.searched, context.prefilter, context.windows, windows, whole, context.segment, blobs
    )
    count = _drop_known(blobs, count, known, context)
    observation = Observation(blobs, count, pixels, context.classes, context.camera)
    robots = find_robots(observation, context.robots, known, frame.robots)
    balls = find_balls(observation, frame.robots, robots, context.balls, frame.balls)
    frame.complete, frame.counts[0], frame.counts[1] = complete, robots, balls
    return count


@kernel
def _drop_known(blobs: Table, count: int, known: int, context: PerceptionContext) -> int:
    """Drop the blobs on robots that are verified, but for those of the ball's color; returns how many are left."""
    kept, found, radii_px2 = 0, context.robots.buffers.found, context.robots.buffers.known_px2
    for one in range(count):
        blob, is_known = blobs[one], False
        for robot in range(known):
            dx, dy = blob.x_px - found[robot].x_px, blob.y_px - found[robot].y_px
            is_known |= dx * dx + dy * dy < radii_px2[robot]
        if not is_known or blob.color == context.balls.color:
            blobs[kept] = blobs[one]
            kept += 1
    return kept


@kernel
def _follow_ball(ball: Row, frame: Row, gap_s: float) -> None:
    """Note the first ball of a frame and its speed since the last one. ball: a row of FOLLOWED_BALL."""
    if frame.counts[1] == 0:
        ball.x_m = ball.y_m = ball.x_m_s = ball.y_m_s = np.nan
        return
    x_m, y_m = frame.balls[0].x_m, frame.balls[0].y_m
    ball.x_m_s = ball.y_m_s = 0.0
    if 0.0 < gap_s <= MAX_GAP_S and not np.isnan(ball.x_m):
        ball.x_m_s, ball.y_m_s = (x_m - ball.x_m) / gap_s, (y_m - ball.y_m) / gap_s
    ball.x_m, ball.y_m = x_m, y_m


@kernel
def _place_windows(frame: Row, known: int, gap_s: float, context: PerceptionContext) -> int:
    """Put a window around everything in the last frame that is not verified, as large as it can have moved.

    Returns how many there are. known: how many robots are verified.
    """
    robots, balls, found, count = frame.counts[0], frame.counts[1], context.robots.buffers.found, 0
    ball = context.ball[0]
    for k in range(robots + balls):
        if k < robots:
            kind, x_m, y_m = frame.robots[k].team, frame.robots[k].x_m, frame.robots[k].y_m
            if row_of(found, known, kind, frame.robots[k].id) != NO_ROW:
                continue
            margin_m = gap_s * MAX_ROBOT_M_S
        else:
            kind, x_m, y_m = BALL_KIND, frame.balls[k - robots].x_m, frame.balls[k - robots].y_m
            margin_m = BALL_MARGIN_M
            if k == robots:
                dx, dy = gap_s * ball.x_m_s, gap_s * ball.y_m_s
                x_m, y_m, margin_m = x_m + dx, y_m + dy, margin_m + BALL_CHANGE * math.hypot(dx, dy)
        height_m = context.heights_m[kind]
        x, y = pixel_from_field(context.camera, x_m, y_m, height_m)
        scale = np.sqrt(pixels_per_square_metre(context.camera, x_m, y_m, height_m))
        reach = scale * (context.radii_m[kind] + margin_m)
        window = context.windows[count]
        count += 1
        window[0], window[1] = np.int32(x - reach), np.int32(y - reach)
        window[2], window[3] = np.int32(x + reach), np.int32(y + reach)
    return count


class _ColorMemory:
    """The memory in which kernels read the colors: they see it as it is, so new colors cost a frame nothing."""

    def __init__(self, table: ColorTable) -> None:
        self._classes, self._searched = np.zeros_like(table.classes), np.zeros_like(table.classes)
        self._means, self._spreads = np.zeros_like(table.references.means), np.zeros_like(table.references.spreads)
        self._limits = np.zeros((2, CONDITIONS), dtype=np.uint8)
        references = References(frozen(self._means.view()), frozen(self._spreads.view()))
        self.table = replace(table, classes=frozen(self._classes.view()), references=references)
        """What kernels are given."""
        self.searched: Bytes = frozen(self._searched.view())
        self.prefilter = ColorPrefilter(frozen(self._limits[0].view()), frozen(self._limits[1].view()))

    def hold(self, table: ColorTable, searched: ColorTable) -> None:
        """Write a table into the memory. searched: the same without the classes that are not searched."""
        self._classes[:], self._searched[:] = table.classes, searched.classes
        self._means[:], self._spreads[:] = table.references.means, table.references.spreads
        self._limits[:] = prefilter_from(searched)


class Perception:
    """Perceives the frames of one camera. Its state is where robots and ball were in the last frame.

    Raises SettingsError when a pattern file is missing or wrong, or has colors without a class.
    """

    def __init__(self, settings: Settings, camera: CameraSetup) -> None:
        self.settings = settings
        self.camera = camera
        self.table = compile_color_table(settings.colors)
        self._colors = _ColorMemory(self.table)
        self.lighting = Lighting(settings, camera)
        self.context = self._context()
        self._shapes = shapes_from(settings, self.context.robots.markers)
        self.blobs: Table = np.zeros(settings.blobs.max_blobs, dtype=BLOB)
        self.blob_count = 0
        """How many blobs the last frame has, but for those on verified robots: the first rows of ``blobs``."""
        self.raw: Bytes = np.zeros((0, 0, 3), dtype=np.uint8)
        """The last frame."""
        self.pixels = self.raw
        """The last frame, corrected to the venue's light."""
        self._seen = SightingsTable()
        self._last = Instant(0)
        self._gap_s = ALONE
        held, cursor = self.context.held, self.context.segment.cursor
        self._rewind = Rewind(
            [self._seen.whole, self.context.expected, self.context.ball, held.robots, held.size, cursor]
        )

    @cached_property
    def _boxed(self) -> Boxed:
        """``context`` as an argument of kernels; made at the first frame, so that settings are checked without it."""
        return box(self.context)

    @cached_property
    def _boxed_shapes(self) -> Boxed:
        return box(self._shapes)

    def warm_up(self) -> None:
        """Load or compile the kernels, so that no frame waits for it."""
        dark = ImageFrame(self.camera.name, 0, Instant(0), self.camera.black_image())
        self.perceive(dark, ManualClock())
        self.confirm(NOTHING)
        self.lighting.warm_up()

    def recolor(self, table: ColorTable) -> None:
        """See the next frames with other colors of the same classes. Raises ValueError for other classes."""
        if table.names != self.table.names:
            raise ValueError(f"classes {table.names}; accepted: {self.table.names}")
        self.table = table
        self._colors.hold(table, keep_classes(table, self._searched_names))

    def perceive(self, frame: ImageFrame, clock: Clock) -> SightingsTable:
        """The sightings of a frame of the configured size. The next call overwrites the table.

        A frame that is not later than the last one is searched whole, as a single picture.
        """
        return self._seen_in(frame, self.lighting.lit(frame.pixels, frame.grabbed), clock)

    def perceive_lit(self, frame: ImageFrame, clock: Clock) -> SightingsTable:
        """The same for a frame that is in the light of the settings."""
        return self._seen_in(frame, frame.pixels, clock)

    def rehearse(self, give_way: Callable[[], bool]) -> bool:
        """Perceive the last frame once more and undo it, so that the next one finds warm caches.

        give_way: is asked between the stages, True ends the rehearsal. Returns whether it was a whole one.
        """
        with self._rewind.rewound() as was_run:
            if not was_run or give_way():
                return False
            pixels = read_only(self.lighting.relit(self.raw))
            if give_way():
                return False
            perceive_picture(pixels, self._gap_s, self._boxed, self.blobs, self._seen.whole)
            return True

    def perceive_alone(self, frame: ImageFrame, clock: Clock) -> SightingsTable:
        """The same for a single picture: no robot of the frames before is held."""
        self._last = frame.grabbed
        return self.perceive(frame, clock)

    def perceive_still(self, frame: ImageFrame, clock: Clock) -> SightingsTable:
        """What the running service sees of a standing picture: its slow search for shapes has had its time.

        The next call overwrites the table.
        """
        seen = self.perceive_alone(frame, clock)
        self.unseen_robots()
        return seen

    def suggest(self, suggestions: Suggestions) -> None:
        """Look for robots at these poses too, in the next frames until others are suggested."""
        count = len(suggestions.poses)
        self._shapes.plain[:] = suggestions.plain
        self._shapes.suggested[:count] = suggestions.poses
        self._shapes.size[0] = count

    def confirm(self, suggestions: Suggestions) -> Table:
        """Look for robots at these poses in the last frame, too; returns all of its robots, like ``robots``."""
        self.suggest(suggestions)
        self._confirm(ALONE)
        self.suggest(NOTHING)
        return self.robots

    def unseen_robots(self) -> Suggestions:
        """The robots of the last frame that its blobs do not show, added to ``robots``.

        It takes a fraction of a second.
        """
        before = self.robots.copy()
        suggested = self.shape_search.suggest(self.pixels, before)
        return Suggestions(suggested.plain, self.shape_search.new_poses(before, self.confirm(suggested)))

    @property
    def robots(self) -> Table:
        """The robots of the last frame, ROBOT; the next one overwrites them."""
        seen = self._seen.whole[0]
        robots: Table = seen["robots"][: seen["counts"][0]]
        return robots

    @cached_property
    def shape_search(self) -> ShapeSearch:
        """The slow search for robots that blobs do not show."""
        return ShapeSearch(self.settings, self.camera, self.context.robots.markers, self._shapes)

    def _seen_in(self, frame: ImageFrame, lit: Bytes, clock: Clock) -> SightingsTable:
        self.raw, self.pixels = frame.pixels, read_only(lit)
        gap_s = (frame.grabbed - self._last) / NS_PER_S if frame.grabbed > self._last else ALONE
        self._last, self._gap_s = frame.grabbed, gap_s
        self._rewind.keep()
        self.blob_count, is_missing = perceive_picture(self.pixels, gap_s, self._boxed, self.blobs, self._seen.whole)
        if is_missing or self._shapes.size[0]:
            self._confirm(gap_s)
        self._seen.stamp(frame.camera, frame.number, frame.grabbed, clock.now())
        return self._seen

    def _confirm(self, gap_s: float) -> None:
        confirm_picture(self.pixels, gap_s, self._boxed, self._boxed_shapes, self.blobs, self._seen.whole)

    def _context(self) -> PerceptionContext:
        settings = self.settings
        shapes = [robots_of(settings.robots, team) for team in TEAMS]
        patterns = {pattern.name: pattern for team in TEAMS for pattern in worn_patterns(settings.robots, team)}
        table = self._colors.table
        robots = robot_finder(settings, table)
        colors = {color for pattern in patterns.values() for color in _colors_of(pattern)}
        self._searched_names = {*colors, settings.ball.color}
        self._colors.hold(self.table, keep_classes(self.table, self._searched_names))
        radius = settings.ball.radius_m
        rows_apart = min_height_px(self._smallest_px(patterns.values()), settings.blobs.row_step)
        return PerceptionContext(
            classes=table.classes,
            searched=self._colors.searched,
            prefilter=self._colors.prefilter,
            camera=camera_map_from(self.camera.model),
            segment=segment_buffers(*self.camera.size_px, settings.blobs, rows_apart, bits_of(self.camera.masked)),
            robots=robots,
            held=held_robots(),
            balls=ball_finder(settings, table),
            heights_m=np.array([*(shape.height_m for shape in shapes), radius]),
            radii_m=np.array([*(2.0**0.5 * shape.radius_m for shape in shapes), radius]),
            windows=np.zeros((MAX_ROBOTS + MAX_BALLS, 4), dtype=np.int32),
            expected=np.zeros(1, dtype=EXPECTED),
            ball=np.full(1, np.nan, dtype=FOLLOWED_BALL),
        )

    def _smallest_px(self, patterns: Iterable[Pattern]) -> float:
        """Diameter of the smallest object that is searched for, where the image's scale is smallest [px]."""
        patches = [width_mm(patch) / MM_PER_M for pattern in patterns for layout in pattern.layouts for patch in layout]
        smallest_m = min(*patches, 2.0 * self.settings.ball.radius_m)
        x, y = accepted_half_extent(self.settings.field)
        corners = np.array([(0.0, 0.0), (x, y), (x, -y), (-x, y), (-x, -y)])
        scale = np.sqrt(self.camera.model.pixels_per_square_metre(corners))
        return smallest_m * float(np.nanmin(scale))


def _colors_of(pattern: Pattern) -> set[str]:
    """Color classes that a pattern's patches may have."""
    plain = {patch.color for patch in pattern.patches} - {TEAM, CODE}
    return {*map(pattern.team_color, TEAMS), *plain, *pattern.code.colors}
