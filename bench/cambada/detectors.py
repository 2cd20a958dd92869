"""The ten detectors: one class for each kind of object, all with ``detect(pixels, at)``."""

import math
from collections.abc import Callable
from typing import Protocol, TypeAlias

import numpy as np

from bench.cambada.profiles import Strip, normals
from bench.region_growing.region import color_of_classes, color_of_seed
from bench.region_growing.tracker import GrowingLimits, GrowingTracker
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

Positions: TypeAlias = tuple[tuple[float, float], ...]
"""Positions of the objects found in an image: x and y of each [px]."""

MIN_BOUNDARY = 0.5
"""Least share of the walls in the picture whose foot is found."""
CARPET_TOLERANCES, MIN_AROUND = (60.0, 20.0), 0.3
"""Tolerances of luma and chroma [grey levels]; least share of carpet around a ball or goal: objects hide the rest."""
GOAL_TOLERANCES = (26.0, 8.0)
"""Of luma and chroma [grey levels]."""
GOAL_AREA = (0.3, 2.5)
"""Least and largest area of a goal, as shares of the area of its back wall in the image."""
POINTS_PER_LINE, MIN_LINES = 40, 0.5
"""Points on each line; least share of the lines that must be found."""
CORNER_SIDE_M = (0.04, 0.28)
"""The two sides of a corner are searched between these distances from it."""


class Detector(Protocol):
    """Detects one kind of object in the images of one camera."""

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:
        """Positions of its objects in an image, or None.

        pixels: shape (height, width, 3), channels blue, green, red; at: when the image was grabbed.
        """
        ...


class ObstacleDetector:
    """Everything that stands on the carpet. It does not know which of these are robots."""

    def __init__(self, settings: Settings) -> None:
        camera, size = CameraSetup.from_settings(settings).model, _size(settings)
        self._finder = ObstacleFinder(
            settings.field, settings.robots, settings.ball.radius_m, camera, size, settings.obstacles
        )

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:  # noqa: ARG002
        """The centers of all obstacles."""
        return tuple((obstacle.x_px, obstacle.y_px) for obstacle in self._finder.find(pixels, (), ())) or None


class BoundaryDetector:
    """The boundary of the carpet."""

    def __init__(self, settings: Settings) -> None:
        self._finder = BoundaryFinder(settings.field, CameraSetup.from_settings(settings).model, _size(settings))

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:  # noqa: ARG002
        """Points on the boundary."""
        boundary = self._finder.find(pixels)
        if boundary.found < MIN_BOUNDARY:
            return None
        return tuple((x, y) for x, y in boundary.points_px if math.isfinite(x))


class BallDetector:
    """The ball, by region growing in its color class."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._tracker: GrowingTracker | None = None

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:
        """Its center."""
        if self._tracker is None:
            self._tracker = self._new_tracker(pixels)
        return _track(self._tracker, pixels, at)

    def _new_tracker(self, pixels: Bytes) -> GrowingTracker:
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
    """The inside of a goal, by region growing in the color of its paint."""

    def __init__(self, settings: Settings, side: float) -> None:
        """side: -1 for the goal at negative x, 1 for the other."""
        self._settings, self._side = settings, side
        self._tracker: GrowingTracker | None = None

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:
        """Its center."""
        if self._tracker is None:
            self._tracker = self._new_tracker(pixels)
        return _track(self._tracker, pixels, at)

    def _new_tracker(self, pixels: Bytes) -> GrowingTracker:
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
    """Robots and ball, by color segmentation of the whole picture; every image is processed independently."""

    def __init__(self, settings: Settings) -> None:
        self._camera, self._clock = CameraSetup.from_settings(settings), MonotonicClock()
        self._perception = Perception(settings, self._camera)

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:  # noqa: ARG002
        """The robots' and the balls' centers."""
        sightings = self._perception.perceive(
            ImageFrame(self._camera.name, 0, Instant(0), pixels), self._clock
        ).record()
        robots = tuple((robot.x_px, robot.y_px) for robot in sightings.robots)
        return (*robots, *((ball.x_px, ball.y_px) for ball in sightings.balls)) or None


class LineDetector:
    """Painted lines."""

    def __init__(self, settings: Settings, paths_m: list[Floats], min_share: float) -> None:
        """paths_m: points along each line, shape (n, 2) [m]; min_share: share of the lines that must be found."""
        camera, size = CameraSetup.from_settings(settings).model, _size(settings)
        self._strips = [Strip(camera, path, normals(path), size) for path in paths_m]
        self._min_share = min_share

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:  # noqa: ARG002
        """The middles of all lines that are found."""
        offsets = [(strip, strip.line_px(pixels)) for strip in self._strips]
        found = tuple(strip.middle_px(px) for strip, px in offsets if px is not None)
        return found if len(found) >= max(self._min_share * len(self._strips), 1) else None


class CornerDetector:
    """The two corners of the field at one end: where the inner edges of its lines or walls meet."""

    def __init__(self, settings: Settings, side: float) -> None:
        """side: -1 for the end at negative x, 1 for the other."""
        field, camera, size = settings.field, CameraSetup.from_settings(settings).model, _size(settings)
        half = np.array([field.length_m, field.width_m]) / 2.0 - field.line_width_m
        steps = np.linspace(*CORNER_SIDE_M, POINTS_PER_LINE)[:, None]
        self._corners = []
        for up in (-1.0, 1.0):
            corner, along_x, along_y = half * (side, up), np.array([side, 0.0]), np.array([0.0, up])
            end = Strip(camera, corner - steps * along_y, np.tile(along_x, (POINTS_PER_LINE, 1)), size)
            flank = Strip(camera, corner - steps * along_x, np.tile(along_y, (POINTS_PER_LINE, 1)), size)
            self._corners.append((camera.pixel_from_field(corner[None])[0], end, flank))

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:  # noqa: ARG002
        """The corners that are found."""
        found = []
        for corner, end, flank in self._corners:
            along, across = end.edge_px(pixels), flank.edge_px(pixels)
            if along is not None and across is not None:
                x, y = (corner + along * end.normal + across * flank.normal).tolist()
                found.append((x, y))
        return tuple(found) or None


def _all_lines(settings: Settings) -> Detector:
    return LineDetector(settings, painted_points(settings.field, POINTS_PER_LINE), MIN_LINES)


def _keeper_line(settings: Settings) -> Detector:
    """The part of blue's goal line between the posts, where carpet lies on both of its sides."""
    field = settings.field
    x = _blue_side(settings) * (field.length_m - field.line_width_m) / 2.0
    half = 0.9 * field.goal.width_m / 2.0
    return LineDetector(settings, [np.linspace((x, -half), (x, half), POINTS_PER_LINE)], 1.0)


DETECTORS: dict[str, Callable[[Settings], Detector]] = {
    "avoid_om": ObstacleDetector,
    "avoid_fr": BoundaryDetector,
    "ball_om": BallDetector,
    "ball_fr": WholePictureDetector,
    "kgoal": _keeper_line,
    "bgoal": lambda settings: GoalDetector(settings, _blue_side(settings)),
    "ygoal": lambda settings: GoalDetector(settings, -_blue_side(settings)),
    "line": _all_lines,
    "bpost": lambda settings: CornerDetector(settings, _blue_side(settings)),
    "ypost": lambda settings: CornerDetector(settings, -_blue_side(settings)),
}
"""By the task's name."""


def detector_of(name: str, settings: Settings) -> Detector:
    """The detector of a task, with its kernels compiled. Raises KeyError for a name that is not in the paper."""
    noise = np.random.default_rng(1).integers(0, 255, (*reversed(_size(settings)), 3), dtype=np.uint8)
    DETECTORS[name](settings).detect(
        noise, Instant(0)
    )  # compiles the kernels; the detector that is returned has no state yet
    return DETECTORS[name](settings)


def _size(settings: Settings) -> tuple[int, int]:
    return CameraSetup.from_settings(settings).size_px


def _blue_side(settings: Settings) -> float:
    return -1.0 if settings.match.blue_defends == "left" else 1.0


def _square_scale(settings: Settings, place_m: tuple[float, float], height_m: float) -> float:
    """Area of a square metre in the image [px^2], at a place and height."""
    return float(CameraSetup.from_settings(settings).model.pixels_per_square_metre(np.array([place_m]), height_m)[0])


def _polygon_area(points: Floats) -> float:
    """Area of a polygon. points: its corners, shape (n, 2)."""
    x, y = points.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


def _track(tracker: GrowingTracker, pixels: Bytes, at: Instant) -> Positions | None:
    return None if tracker.follow(pixels, at) is None else (tracker.last_px,)


def _carpet(settings: Settings, pixels: Bytes) -> Table:
    """The carpet's color, from a grid of points on the field."""
    steps = np.linspace(-0.45, 0.45, 20)
    points = np.stack(np.meshgrid(steps * settings.field.length_m, steps * settings.field.width_m), axis=-1)
    places = CameraSetup.from_settings(settings).model.pixel_from_field(points.reshape(-1, 2)).round().astype(int)
    x, y = np.clip(places, 0, np.array(_size(settings)) - 1).T
    blue, green, red = np.median(pixels[y, x], axis=0).tolist()
    return color_of_seed((blue, green, red), *CARPET_TOLERANCES)
