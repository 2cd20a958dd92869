"""Things of robot size that nobody knows: what differs from the carpet that was learned, and is no robot, ball or line.

The field is looked at on a grid of cells, three to a robot's radius, each the mean of nine pixels. Per cell the
carpet's color is learned: at first it is the median of a neighborhood larger than a robot (painted lines, which the
field's measures tell, are learned as soon as nothing known covers them), later it follows slowly where nothing
stands. So light that changes by and by and stains on the carpet are no obstacles, and a bag that somebody put down
stays one.

A shadow darkens and keeps its hue: darkening alone must be stronger than a change of color. After CAMBADA's obstacle
detection (Neves et al., modular vision), whose carpet is green; here any plain one will do.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel
from vision_core.models.field import accepted_half_extent, painted_points
from vision_core.native.opencv import connected_regions, median_filtered
from vision_core.settings.schema import FieldSettings, ObstacleSettings, RobotShape
from vision_core.types.objects import BallSighting, ObstacleSighting, RobotSighting

Mask = NDArray[np.bool_]

CELLS_PER_RADIUS = 3
NEIGHBORHOOD = 2.5
"""Side of the neighborhood whose median is carpet, in robots' diameters."""
COVER = 1.35
"""A robot's body and its soft shadow cover so many of its radii, a ball twice as many of its own."""
LEARNED_PER_LOOK = 0.05
ANOTHER_LIGHT = 0.3
"""When more than this share of the field differs, lamps were switched: the carpet is learned anew."""
DARKEST_SHADOW = 0.45
"""Share of the carpet's light that a shadow leaves; what is darker is a thing."""
BRIGHTER = 0.35
"""Share of the carpet's brightness by which a thing must differ, beside the grey levels of the settings."""
LONGEST = 3.0
MIN_FILL = 0.4
"""Longer side of a thing's box over the shorter, and the share of the box that it fills: walls' shadows are long."""
POINTS_PER_LINE = 200


class ObstacleFinder:
    """Learns the carpet of one camera's field and finds what stands on it. Holds the carpet, so call it in order."""

    def __init__(
        self,
        field: FieldSettings,
        robots: RobotShape,
        ball_radius_m: float,
        camera: CameraModel,
        size_px: tuple[int, int],
        settings: ObstacleSettings,
    ) -> None:
        self._robots, self._ball_radius_m, self._camera, self._settings = robots, ball_radius_m, camera, settings
        self._cell_m = robots.radius_m / CELLS_PER_RADIUS
        half = np.array(accepted_half_extent(field))
        columns, rows = np.maximum(np.floor(2.0 * half / self._cell_m).astype(int), 1)
        x = (np.arange(columns) - (columns - 1) / 2.0) * self._cell_m
        y = (np.arange(rows) - (rows - 1) / 2.0) * self._cell_m
        self._places_m: Floats = np.stack(np.meshgrid(x, y), axis=-1)
        pixel = camera.pixel_from_field(self._places_m.reshape(-1, 2))
        self._visible: Mask = (
            (pixel > 1.0).all(axis=1) & (pixel < np.array(size_px) - 2.0).all(axis=1) & np.isfinite(pixel).all(axis=1)
        ).reshape(rows, columns)
        self._pixel = np.where(np.isfinite(pixel), pixel, 0.0).round().astype(np.intp)[self._visible.ravel()]
        self._painted = self._near(_paint(field), field.line_width_m / 2.0 + self._cell_m)
        self._carpet: Floats | None = None
        self._unlearned = self._painted

    def find(
        self, pixels: Bytes, robots: Sequence[RobotSighting], balls: Sequence[BallSighting]
    ) -> tuple[ObstacleSighting, ...]:
        """The obstacles of an image: shape (height, width, 3), blue green red; robots, balls: what is known there."""
        if not self._visible.any():
            return ()
        seen, free = self._sampled(pixels), self._visible & ~self._known(robots, balls)
        if self._carpet is None:
            self._carpet, self._unlearned = self._first_carpet(seen), self._painted.copy()
        fresh = free & self._unlearned
        self._carpet[fresh] = seen[fresh]
        self._unlearned &= ~fresh
        strange = self._differs(seen) & free & ~self._unlearned
        if strange.sum() > ANOTHER_LIGHT * self._visible.sum():
            self._carpet = None
            return ()
        calm = free & ~strange
        self._carpet[calm] += LEARNED_PER_LOOK * (seen[calm] - self._carpet[calm])
        return self._things(strange)

    def _sampled(self, pixels: Bytes) -> Floats:
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
        side = 2 * round(NEIGHBORHOOD * self._robots.radius_m / self._cell_m) + 1
        margin = side // 2  # beyond the field all is as its middle color: a wall at its edge is no majority
        padded = np.empty((seen.shape[0] + 2 * margin, seen.shape[1] + 2 * margin, 3))
        padded[:] = np.median(seen.reshape(-1, 3), axis=0)
        padded[margin:-margin, margin:-margin] = seen
        filtered = median_filtered(padded.round().astype(np.uint8), side)
        return filtered[margin:-margin, margin:-margin].astype(np.float64)

    def _differs(self, seen: Floats) -> Mask:
        assert self._carpet is not None
        (light, color), (carpet_light, carpet_color) = _light_and_color(seen), _light_and_color(self._carpet)
        change = (light - carpet_light) / (self._settings.difference + BRIGHTER * carpet_light)
        shaded = carpet_color * np.clip(light / np.maximum(carpet_light, 1.0), 0.0, 1.0)[..., None]
        turn = np.hypot(*np.moveaxis(color - shaded, -1, 0)) / self._settings.difference
        dark = (light < DARKEST_SHADOW * carpet_light) & (carpet_light - light > self._settings.difference)
        return np.asarray((change > 1.0) | dark | (turn > 1.0))

    def _known(self, robots: Sequence[RobotSighting], balls: Sequence[BallSighting]) -> Mask:
        """Cells that bodies of robots and balls cover in the image: from the foot to the displaced top."""
        mask = np.zeros(self._visible.shape, dtype=np.bool_)
        for robot in robots:
            radius = COVER * self._robots.radius_m * (math.sqrt(2.0) if self._robots.outline == "square" else 1.0)
            mask |= self._near(self._shades((robot.x_m, robot.y_m), self._robots.height_m), radius + self._cell_m)
        for ball in balls:
            reach = 2.0 * self._ball_radius_m + self._cell_m
            mask |= self._near(self._shades((ball.x_m, ball.y_m), self._ball_radius_m), reach)
        return mask

    def _shades(self, place_m: tuple[float, float], height_m: float) -> Floats:
        """Points of the floor that an upright thing hides from the camera, from its foot to its top."""
        place, eye = np.array(place_m), self._camera.position_m
        levels = np.linspace(0.0, height_m, 4)[:, None]
        points: Floats = place + (place - eye[:2]) * (levels / (eye[2] - levels))
        return points

    def _near(self, points_m: Floats, reach_m: float) -> Mask:
        """Cells nearer than a distance to any of some points."""
        mask = np.zeros(self._visible.shape, dtype=np.bool_)
        first, last = self._places_m[0, 0], self._places_m[-1, -1]
        for point in points_m:
            low = np.floor((point - reach_m - first) / self._cell_m).astype(int)
            high = np.ceil((point + reach_m - first) / self._cell_m).astype(int) + 1
            if (point < first - reach_m).any() or (point > last + reach_m).any():
                continue
            box = np.s_[max(low[1], 0) : max(high[1], 0), max(low[0], 0) : max(high[0], 0)]
            arms = self._places_m[box] - point
            mask[box] |= np.hypot(arms[..., 0], arms[..., 1]) <= reach_m
        return mask

    def _things(self, strange: Mask) -> tuple[ObstacleSighting, ...]:
        found = []
        for region in connected_regions(strange):
            radius_m = math.sqrt(region.area_px / math.pi) * self._cell_m
            longer, shorter = max(region.width_px, region.height_px), min(region.width_px, region.height_px)
            fits = self._settings.min_radius_m <= radius_m <= self._settings.max_radius_m
            if fits and longer <= LONGEST * shorter and region.area_px >= MIN_FILL * longer * shorter:
                found.append(self._thing(region.center_px, radius_m))
        return tuple(found)

    def _thing(self, cell: tuple[float, float], radius_m: float) -> ObstacleSighting:
        """An obstacle round a cell; what is seen of an upright thing leans outwards by half its displacement."""
        leaning = self._places_m[0, 0] + np.array(cell) * self._cell_m
        eye = self._camera.position_m
        place = leaning + (eye[:2] - leaning) * (0.5 * self._robots.height_m / eye[2])
        (pixel,) = self._camera.pixel_from_field(leaning[None])
        share = radius_m / self._robots.radius_m
        return ObstacleSighting(
            float(pixel[0]), float(pixel[1]), float(place[0]), float(place[1]), radius_m, min(share, 1.0 / share)
        )


def _paint(field: FieldSettings) -> Floats:
    lines = painted_points(field, POINTS_PER_LINE)
    return np.concatenate(lines) if lines else np.empty((0, 2))


def _light_and_color(bgr: Floats) -> tuple[Floats, Floats]:
    """Luma, and blue and red over it."""
    luma = bgr @ np.array([0.114, 0.587, 0.299])
    return luma, bgr[..., (0, 2)] - luma[..., None]
