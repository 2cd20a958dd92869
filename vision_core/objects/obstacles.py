"""Obstacles: objects of robot size that are no known robot, ball or line, found as differences from the carpet.

The field is sampled on a grid of cells, three to a robot's radius, each the mean of nine pixels. Per cell the carpet's
color is learned: at first as the median of a neighborhood larger than a robot (painted lines, whose places the field's
measures give, are learned as soon as nothing known covers them), later by following slowly where nothing stands. So
light that changes gradually and stains on the carpet are no obstacles, and a bag that somebody puts down stays one.

A shadow is darker and keeps its hue: for a change of brightness alone the threshold is higher than for a change of
color. After CAMBADA's obstacle detection (Neves et al., modular vision), whose carpet is green; here any plain one will
do.
"""

import math
from collections.abc import Sequence

import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.models.camera import CameraModel
from vision_core.models.field import accepted_half_extent, painted_points
from vision_core.native.opencv import connected_regions, median_filtered
from vision_core.settings.schema import FieldSettings, ObstacleSettings, RobotShape
from vision_core.types.colors import LUMA_BGR
from vision_core.types.objects import BallSighting, ObstacleSighting, RobotSighting

CELLS_PER_RADIUS = 3
MAX_CELLS = 1_000_000
"""Limit of the grid's size: a field that needs more cells of a robot's size is a mistake in the settings."""
NEIGHBORHOOD_DIAMETERS = 2.5
"""Side of the neighborhood whose median is carpet, in diameters of a robot."""
COVERED_RADII, COVERED_BALL_RADII = 1.35, 2.0
"""Radius that a robot's body and its soft shadow cover, in radii of the robot; the same for a ball."""
LEARNING_RATE = 0.05
"""Share of the difference by which a free cell's carpet follows the picture, per call."""
NEW_LIGHT_SHARE = 0.3
"""When more than this share of the field differs, the lamps were switched: the carpet is learned anew."""
DARKEST_SHADOW = 0.45
"""Share of the carpet's light that a shadow leaves; darker cells belong to an obstacle."""
MIN_LIGHT_CHANGE = 0.35
"""Share of the carpet's light by which an obstacle must differ, beside the grey levels of the settings."""
MAX_ELONGATION = 3.0
"""Longer side of an obstacle's box over the shorter: shadows of walls are longer."""
MIN_FILL = 0.4
"""Share of its box that an obstacle fills."""
POINTS_PER_LINE = 200


class ObstacleFinder:
    """Learns the carpet of one camera's field and finds what stands on it. Frames must come in order.

    Raises SettingsError when the field is so large, or the robots so small, that the grid would have too many cells.
    """

    def __init__(
        self,
        field: FieldSettings,
        robots: RobotShape,
        ball_radius_m: float,
        camera: CameraModel,
        size_px: tuple[int, int],
        settings: ObstacleSettings,
        masked: Mask | None = None,
    ) -> None:
        """size_px: width and height of the images; masked: pixels in which nothing is looked for, or None."""
        self._robots, self._ball_radius_m, self._camera, self._settings = robots, ball_radius_m, camera, settings
        self._cell_m = robots.radius_m / CELLS_PER_RADIUS
        half = np.array(accepted_half_extent(field))
        columns, rows = (max(math.floor(size), 1) for size in (2.0 * half / self._cell_m).tolist())
        if columns * rows > MAX_CELLS:
            raise SettingsError(
                "obstacles: grid of the field in thirds of robots.radius_m",
                found=f"{columns} x {rows} cells",
                accepted=f"at most {MAX_CELLS} cells: check field.length_m, field.width_m and robots.radius_m",
            )
        x = (np.arange(columns) - (columns - 1) / 2.0) * self._cell_m
        y = (np.arange(rows) - (rows - 1) / 2.0) * self._cell_m
        self._places_m: Floats = np.stack(np.meshgrid(x, y), axis=-1)
        pixel = camera.pixel_from_field(self._places_m.reshape(-1, 2))
        self._visible: Mask = (
            (pixel > 1.0).all(axis=1) & (pixel < np.array(size_px) - 2.0).all(axis=1) & np.isfinite(pixel).all(axis=1)
        ).reshape(rows, columns)
        if masked is not None:
            column, row = np.where(self._visible.reshape(-1, 1), pixel, 0.0).round().astype(np.intp).T
            self._visible &= ~masked[row, column].reshape(rows, columns)
        self._pixel = np.where(np.isfinite(pixel), pixel, 0.0).round().astype(np.intp)[self._visible.ravel()]
        self._painted = self._near(_paint(field), field.line_width_m / 2.0 + self._cell_m)
        self._carpet: Floats | None = None
        self._to_learn = self._painted

    def find(
        self, pixels: Bytes, robots: Sequence[RobotSighting], balls: Sequence[BallSighting]
    ) -> tuple[ObstacleSighting, ...]:
        """The obstacles of an image.

        pixels: shape (height, width, 3), blue green red; robots, balls: found in the same image.
        """
        if not self._visible.any():
            return ()
        seen, free = self._sample(pixels), self._visible & ~self._covered(robots, balls)
        if self._carpet is None:
            self._carpet, self._to_learn = self._first_carpet(seen), self._painted.copy()
        fresh = free & self._to_learn
        self._carpet[fresh] = seen[fresh]
        self._to_learn &= ~fresh
        different = self._differs(seen) & free & ~self._to_learn
        if different.sum() > NEW_LIGHT_SHARE * self._visible.sum():
            self._carpet = None
            return ()
        empty = free & ~different
        self._carpet[empty] += LEARNING_RATE * (seen[empty] - self._carpet[empty])
        return self._obstacles(different)

    def _sample(self, pixels: Bytes) -> Floats:
        """Mean color of every cell's nine pixels, shape (rows, columns, 3)."""
        x, y = self._pixel[:, 0], self._pixel[:, 1]
        total = np.zeros((len(x), 3))
        for dy in (-1, 0, 1):
            for dx in (-1, 0, 1):
                total += pixels[y + dy, x + dx]
        grid = np.empty((*self._visible.shape, 3))
        grid[:] = np.median(total, axis=0) / 9.0
        grid[self._visible] = total / 9.0
        return grid

    def _first_carpet(self, seen: Floats) -> Floats:
        """The carpet before anything is learned: the median of each cell's neighborhood, shape (rows, columns, 3)."""
        side = 2 * round(NEIGHBORHOOD_DIAMETERS * self._robots.radius_m / self._cell_m) + 1
        margin = side // 2  # the surroundings get the field's median color, so that a wall never is the majority
        padded = np.empty((seen.shape[0] + 2 * margin, seen.shape[1] + 2 * margin, 3))
        padded[:] = np.median(seen.reshape(-1, 3), axis=0)
        padded[margin:-margin, margin:-margin] = seen
        filtered = median_filtered(padded.round().astype(np.uint8), side)
        return filtered[margin:-margin, margin:-margin].astype(np.float64)

    def _differs(self, seen: Floats) -> Mask:
        """Which cells differ from the carpet in light or color by more than a shadow does."""
        assert self._carpet is not None
        (light, color), (carpet_light, carpet_color) = _light_and_color(seen), _light_and_color(self._carpet)
        brighter = (light - carpet_light) / (self._settings.difference + MIN_LIGHT_CHANGE * carpet_light)
        shaded = carpet_color * np.clip(light / np.maximum(carpet_light, 1.0), 0.0, 1.0)[..., None]
        color_change = np.hypot(*np.moveaxis(color - shaded, -1, 0)) / self._settings.difference
        dark = (light < DARKEST_SHADOW * carpet_light) & (carpet_light - light > self._settings.difference)
        return np.asarray((brighter > 1.0) | dark | (color_change > 1.0))

    def _covered(self, robots: Sequence[RobotSighting], balls: Sequence[BallSighting]) -> Mask:
        """Cells that robots and balls cover in the image, from the foot to the top, which parallax displaces."""
        mask = np.zeros(self._visible.shape, dtype=np.bool_)
        for robot in robots:
            radius = (
                COVERED_RADII * self._robots.radius_m * (math.sqrt(2.0) if self._robots.outline == "square" else 1.0)
            )
            mask |= self._near(self._hidden_floor((robot.x_m, robot.y_m), self._robots.height_m), radius + self._cell_m)
        for ball in balls:
            reach = COVERED_BALL_RADII * self._ball_radius_m + self._cell_m
            mask |= self._near(self._hidden_floor((ball.x_m, ball.y_m), self._ball_radius_m), reach)
        return mask

    def _hidden_floor(self, place_m: tuple[float, float], height_m: float) -> Floats:
        """Points of the floor that an upright object hides from the camera, from its foot to its top, shape (4, 2)."""
        place, eye = np.array(place_m), self._camera.position_m
        levels = np.linspace(0.0, height_m, 4)[:, None]
        points: Floats = place + (place - eye[:2]) * (levels / (eye[2] - levels))
        return points

    def _near(self, points_m: Floats, reach_m: float) -> Mask:
        """Cells nearer than a distance to any of the points, shape (n, 2)."""
        mask = np.zeros(self._visible.shape, dtype=np.bool_)
        first, last = self._places_m[0, 0], self._places_m[-1, -1]
        for point in points_m:
            low = np.floor((point - reach_m - first) / self._cell_m).astype(int)
            high = np.ceil((point + reach_m - first) / self._cell_m).astype(int) + 1
            if (point < first - reach_m).any() or (point > last + reach_m).any():
                continue
            box = np.s_[max(low[1], 0) : max(high[1], 0), max(low[0], 0) : max(high[0], 0)]
            offsets = self._places_m[box] - point
            mask[box] |= np.hypot(offsets[..., 0], offsets[..., 1]) <= reach_m
        return mask

    def _obstacles(self, different: Mask) -> tuple[ObstacleSighting, ...]:
        """Connected regions of robot size and compact outline."""
        found = []
        for region in connected_regions(different):
            radius_m = math.sqrt(region.area_px / math.pi) * self._cell_m
            longer, shorter = max(region.width_px, region.height_px), min(region.width_px, region.height_px)
            fits = self._settings.min_radius_m <= radius_m <= self._settings.max_radius_m
            if fits and longer <= MAX_ELONGATION * shorter and region.area_px >= MIN_FILL * longer * shorter:
                found.append(self._obstacle(region.center_px, radius_m))
        return tuple(found)

    def _obstacle(self, cell: tuple[float, float], radius_m: float) -> ObstacleSighting:
        """An obstacle seen round a cell: upright objects appear farther out, by half the parallax of their top."""
        leaning = self._places_m[0, 0] + np.array(cell) * self._cell_m
        eye = self._camera.position_m
        place = leaning + (eye[:2] - leaning) * (0.5 * self._robots.height_m / eye[2])
        (pixel,) = self._camera.pixel_from_field(leaning[None])
        share = radius_m / self._robots.radius_m
        return ObstacleSighting(
            float(pixel[0]), float(pixel[1]), float(place[0]), float(place[1]), radius_m, min(share, 1.0 / share)
        )


def _paint(field: FieldSettings) -> Floats:
    """Points on all painted lines, shape (n, 2) [m]."""
    lines = painted_points(field, POINTS_PER_LINE)
    return np.concatenate(lines) if lines else np.empty((0, 2))


def _light_and_color(bgr: Floats) -> tuple[Floats, Floats]:
    """Luma, and how much blue and red exceed it."""
    luma = bgr @ LUMA_BGR
    return luma, bgr[..., (0, 2)] - luma[..., None]
