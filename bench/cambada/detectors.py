"""What the tasks look for: one class for each kind of thing, all with ``look(pixels, at)``."""

import math
from collections.abc import Callable
from typing import Protocol, TypeAlias

import numpy as np

from bench.cambada.profiles import Strip, normals
from vision_core.blobs.growing import color_of_classes, color_of_seed
from vision_core.blobs.growing_tracker import GrowingLimits, GrowingTracker
from vision_core.capture.synthetic.floor import COLORS, NET_LEFT, NET_RIGHT
from vision_core.clock import Instant, MonotonicClock
from vision_core.color.lookup_table import compile_color_table, keep_classes
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import goal_line_x, painted_points
from vision_core.objects.obstacles import ObstacleFinder
from vision_core.pipeline.perception import Perception
from vision_core.regions.boundary import BoundaryFinder
from vision_core.settings.schema import Settings
from vision_core.types.image import ImageFrame
from vision_core.types.tables import Table

Places: TypeAlias = tuple[tuple[float, float], ...]
"""Where in the image something was found, x and y [px]."""

MIN_BOUNDARY = 0.5
"""Share of the walls in the picture whose foot must be seen."""
CARPET_TOLERANCES, MIN_AROUND = (60.0, 20.0), 0.3
"""Of luma and chroma [grey levels]; share of carpet round a ball or goal, of which other things hide the rest."""
GOAL_TOLERANCES = (26.0, 8.0)
GOAL_AREA = (0.3, 2.5)
"""Least and most, as shares of the area that its back fills as seen from above."""
POINTS_PER_LINE, MIN_LINES = 40, 0.5
ARM_M = (0.04, 0.28)
"""A corner is looked for along its two sides, between these distances from it."""


class Detector(Protocol):
    """Looks for one thing in the images of one camera."""

    def look(self, pixels: Bytes, at: Instant) -> Places | None:
        """Where it is; None: not there. pixels: shape (height, width, 3), blue green red; at: when it was grabbed."""
        ...


class ObstacleDetector:
    """Whatever stands on the carpet; nobody has told it which of these are robots."""

    def __init__(self, settings: Settings) -> None:
        camera, size = CameraSetup.from_settings(settings).model, _size(settings)
        self._finder = ObstacleFinder(
            settings.field, settings.robots, settings.ball.radius_m, camera, size, settings.obstacles
        )

    def look(self, pixels: Bytes, at: Instant) -> Places | None:  # noqa: ARG002
        """The middles of all things."""
        return tuple((thing.x_px, thing.y_px) for thing in self._finder.find(pixels, (), ())) or None


class BoundaryDetector:
    """Where the carpet ends."""

    def __init__(self, settings: Settings) -> None:
        self._finder = BoundaryFinder(settings.field, CameraSetup.from_settings(settings).model, _size(settings))

    def look(self, pixels: Bytes, at: Instant) -> Places | None:  # noqa: ARG002
        """Points of the boundary."""
        boundary = self._finder.find(pixels)
        if boundary.found < MIN_BOUNDARY:
            return None
        return tuple((x, y) for x, y in boundary.points_px if math.isfinite(x))


class BallDetector:
    """The ball, by region growing in its color class."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._tracker: GrowingTracker | None = None

    def look(self, pixels: Bytes, at: Instant) -> Places | None:
        """Its center."""
        if self._tracker is None:
            self._tracker = self._follower(pixels)
        return _followed(self._tracker, pixels, at)

    def _follower(self, pixels: Bytes) -> GrowingTracker:
        settings = self._settings
        table = keep_classes(compile_color_table(settings.colors), {settings.ball.color})
        radius = settings.ball.radius_m
        area = math.pi * radius**2 * _square_scale(settings, (0.0, 0.0), radius)
        limits = GrowingLimits(
            math.floor(settings.ball.min_area * area),
            math.ceil(settings.ball.max_area * area),
            around=_carpet(settings, pixels),
            min_around=MIN_AROUND,
        )
        color = color_of_classes(table.index(settings.ball.color))
        return GrowingTracker(*_size(settings), color, limits, table)


class GoalDetector:
    """The inside of a goal, by region growing in the color that it is painted with."""

    def __init__(self, settings: Settings, side: float) -> None:
        """side: -1 for the goal at negative x, 1 for the other."""
        self._settings, self._side = settings, side
        self._tracker: GrowingTracker | None = None

    def look(self, pixels: Bytes, at: Instant) -> Places | None:
        """Its middle."""
        if self._tracker is None:
            self._tracker = self._follower(pixels)
        return _followed(self._tracker, pixels, at)

    def _follower(self, pixels: Bytes) -> GrowingTracker:
        settings, camera = self._settings, CameraSetup.from_settings(self._settings).model
        goal = settings.field.goal
        back, half = self._side * (goal_line_x(settings.field) + goal.depth_m), goal.width_m / 2.0
        feet = camera.pixel_from_field(np.array([(back, -half), (back, half)]))
        tops = camera.pixel_from_field(np.array([(back, half), (back, -half)]), settings.field.wall_height_m)
        middle = np.concatenate([feet, tops]).mean(axis=0)
        area = _polygon_area(np.concatenate([feet, tops]))
        blue, green, red = COLORS[NET_LEFT if self._side < 0.0 else NET_RIGHT].tolist()
        limits = GrowingLimits(
            math.floor(GOAL_AREA[0] * area),
            math.ceil(GOAL_AREA[1] * area),
            around=_carpet(settings, pixels),
            min_around=MIN_AROUND,
        )
        color = color_of_seed((blue, green, red), *GOAL_TOLERANCES)
        return GrowingTracker(*_size(settings), color, limits, start_px=(float(middle[0]), float(middle[1])))


class WholePictureDetector:
    """Robots and ball of the whole picture: every image is judged alone, so nothing is left out."""

    def __init__(self, settings: Settings) -> None:
        self._camera, self._clock = settings.camera.name, MonotonicClock()
        self._perception = Perception(settings, CameraSetup.from_settings(settings))

    def look(self, pixels: Bytes, at: Instant) -> Places | None:  # noqa: ARG002
        """The robots' and the balls' centers."""
        seen = self._perception.perceive(ImageFrame(self._camera, 0, Instant(0), pixels), self._clock).record()
        robots = tuple((robot.x_px, robot.y_px) for robot in seen.robots)
        return (*robots, *((ball.x_px, ball.y_px) for ball in seen.balls)) or None


class LineDetector:
    """Painted lines."""

    def __init__(self, settings: Settings, paths_m: list[Floats], least: float) -> None:
        """paths_m: points along each line, shape (n, 2); least: share of the lines that must be there."""
        camera, size = CameraSetup.from_settings(settings).model, _size(settings)
        self._strips = [Strip(camera, path, normals(path), size) for path in paths_m]
        self._least = least

    def look(self, pixels: Bytes, at: Instant) -> Places | None:  # noqa: ARG002
        """The middles of all lines that are seen."""
        aside = [(strip, strip.line_px(pixels)) for strip in self._strips]
        seen = tuple(strip.middle_px(px) for strip, px in aside if px is not None)
        return seen if len(seen) >= max(self._least * len(self._strips), 1) else None


class CornerDetector:
    """The two corners of the field at one end: where the inner edges of line or wall meet."""

    def __init__(self, settings: Settings, side: float) -> None:
        """side: -1 for the end at negative x, 1 for the other."""
        field, camera, size = settings.field, CameraSetup.from_settings(settings).model, _size(settings)
        half = np.array([field.length_m, field.width_m]) / 2.0 - field.line_width_m
        steps = np.linspace(*ARM_M, POINTS_PER_LINE)[:, None]
        self._corners = []
        for up in (-1.0, 1.0):
            corner, along_x, along_y = half * (side, up), np.array([side, 0.0]), np.array([0.0, up])
            end = Strip(camera, corner - steps * along_y, np.tile(along_x, (POINTS_PER_LINE, 1)), size)
            flank = Strip(camera, corner - steps * along_x, np.tile(along_y, (POINTS_PER_LINE, 1)), size)
            self._corners.append((camera.pixel_from_field(corner[None])[0], end, flank))

    def look(self, pixels: Bytes, at: Instant) -> Places | None:  # noqa: ARG002
        """The corners that are seen."""
        seen = []
        for corner, end, flank in self._corners:
            out, up = end.edge_px(pixels), flank.edge_px(pixels)
            if out is not None and up is not None:
                x, y = (corner + out * end.normal + up * flank.normal).tolist()
                seen.append((x, y))
        return tuple(seen) or None


def _all_lines(settings: Settings) -> Detector:
    return LineDetector(settings, painted_points(settings.field, POINTS_PER_LINE), MIN_LINES)


def _keepers_line(settings: Settings) -> Detector:
    """Between the posts, where carpet lies on both of its sides."""
    field = settings.field
    x = _blue_side(settings) * (field.length_m - field.line_width_m) / 2.0
    half = 0.9 * field.goal.width_m / 2.0
    return LineDetector(settings, [np.linspace((x, -half), (x, half), POINTS_PER_LINE)], 1.0)


DETECTORS: dict[str, Callable[[Settings], Detector]] = {
    "avoid_om": ObstacleDetector,
    "avoid_fr": BoundaryDetector,
    "ball_om": BallDetector,
    "ball_fr": WholePictureDetector,
    "kgoal": _keepers_line,
    "bgoal": lambda settings: GoalDetector(settings, _blue_side(settings)),
    "ygoal": lambda settings: GoalDetector(settings, -_blue_side(settings)),
    "line": _all_lines,
    "bpost": lambda settings: CornerDetector(settings, _blue_side(settings)),
    "ypost": lambda settings: CornerDetector(settings, -_blue_side(settings)),
}
"""By the task's name."""


def detector_of(name: str, settings: Settings) -> Detector:
    """A task's detector, with everything loaded that it needs. Raises KeyError for a name that the paper lacks."""
    noise = np.random.default_rng(1).integers(0, 255, (*reversed(_size(settings)), 3), dtype=np.uint8)
    DETECTORS[name](settings).look(noise, Instant(0))  # compiles; the one that is used has seen nothing yet
    return DETECTORS[name](settings)


def _size(settings: Settings) -> tuple[int, int]:
    return settings.camera.width_px, settings.camera.height_px


def _blue_side(settings: Settings) -> float:
    return -1.0 if settings.match.blue_defends == "left" else 1.0


def _square_scale(settings: Settings, place_m: tuple[float, float], height_m: float) -> float:
    """Pixels in a square metre."""
    return float(CameraSetup.from_settings(settings).model.pixels_per_square_metre(np.array([place_m]), height_m)[0])


def _polygon_area(points: Floats) -> float:
    """Area inside a polygon's corners, shape (n, 2)."""
    x, y = points.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


def _followed(tracker: GrowingTracker, pixels: Bytes, at: Instant) -> Places | None:
    return None if tracker.follow(pixels, at) is None else (tracker.last_px,)


def _carpet(settings: Settings, pixels: Bytes) -> Table:
    """The color of the field, from a grid of its points, as what surrounds a thing."""
    steps = np.linspace(-0.45, 0.45, 20)
    points = np.stack(np.meshgrid(steps * settings.field.length_m, steps * settings.field.width_m), axis=-1)
    places = CameraSetup.from_settings(settings).model.pixel_from_field(points.reshape(-1, 2)).round().astype(int)
    x, y = np.clip(places, 0, np.array(_size(settings)) - 1).T
    blue, green, red = np.median(pixels[y, x], axis=0).tolist()
    return color_of_seed((blue, green, red), *CARPET_TOLERANCES)
