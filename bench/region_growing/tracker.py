"""Tracks one object from picture to picture by region growing."""

import math
from dataclasses import dataclass

import numpy as np

from bench.region_growing.region import LIMITS, NOT_FOUND, grow, growing_buffers, step_for
from vision_core.clock import Instant, seconds_between
from vision_core.geometry import Bytes
from vision_core.native.kernels import read_only
from vision_core.types.colors import CELL_COUNT, ColorTable
from vision_core.types.tables import Table


@dataclass(frozen=True, slots=True)
class GrowingLimits:
    """Limits by which a region is accepted as the object, and limits of the search."""

    min_area_px: int
    max_area_px: int
    around: Table | None = None
    """Color that must surround the object, a row of COLOR; None: any."""
    min_around: float = 0.5
    """Smallest share of the surrounding pixels that must have this color."""
    gap_px: int = 2
    """Layers of pixels next to the region that are ignored, since colors mix there."""
    ring_px: int = 2
    """Layers of pixels beyond the gap that are the surroundings."""
    near_px: float = 40.0
    """When the object is found farther from its predicted place, its velocity is set to zero."""
    patience_s: float = 0.0
    """So long after it was last found, the object is searched within near_px: no similar object is taken for it."""
    budget_px: int = 1_000_000
    """Limit of the pixels that are grown in one picture, all regions together."""

    def row(self, search_px: int) -> Table:
        """These limits as a table of one row of LIMITS; search_px: how far from its start the search reaches."""
        limits = np.zeros(1, dtype=LIMITS)
        limits["search_px"], limits["step_px"] = search_px, step_for(self.min_area_px)
        limits["min_area_px"], limits["max_area_px"] = self.min_area_px, self.max_area_px
        limits["gap_px"], limits["ring_px"] = self.gap_px, 0 if self.around is None else self.ring_px
        limits["min_around"], limits["budget_px"] = self.min_around, self.budget_px
        return limits


class GrowingTracker:
    """Tracks one object from picture to picture. All memory is allocated once.

    The search starts at the place that the last two places predict; at first it starts at the picture's center. An
    object that is not found is lost: the search covers the whole picture, at once or after ``patience_s``, until it is
    found again.
    """

    def __init__(
        self,
        width_px: int,
        height_px: int,
        color: Table,
        limits: GrowingLimits,
        table: ColorTable | None = None,
        start_px: tuple[float, float] | None = None,
    ) -> None:
        """color: a row of COLOR; table: the color table, not needed for a seed; start_px: start of the first search."""
        self._buffers = growing_buffers(width_px, height_px)
        self._classes = read_only(np.zeros(CELL_COUNT, dtype=np.uint8) if table is None else table.classes)
        self._color = color
        self._around = color if limits.around is None else limits.around
        self._everywhere = limits.row(max(width_px, height_px))
        self._nearby = limits.row(math.ceil(limits.near_px))
        self._near_px, self._patience_s = limits.near_px, limits.patience_s
        self._x_px, self._y_px = start_px or (width_px / 2.0, height_px / 2.0)
        self._vx_px_s = self._vy_px_s = 0.0
        self._seen: Instant | None = None
        self.lost = True
        """The object was not found in the last picture, or there was no picture yet."""
        self.around = 0.0
        """Share of the surrounding pixels that have the color `around`; 1 when any color may surround it."""

    @property
    def last_px(self) -> tuple[float, float]:
        """Where the object was last found, x and y."""
        return self._x_px, self._y_px

    def predict(self, at: Instant) -> tuple[float, float]:
        """Predicted place of the object at an instant, x and y [px]; its last place when it is lost."""
        if self.lost or self._seen is None:
            return self._x_px, self._y_px
        t = seconds_between(self._seen, at)
        return self._x_px + self._vx_px_s * t, self._y_px + self._vy_px_s * t

    def follow(self, pixels: Bytes, at: Instant) -> Table | None:
        """Find the object in a picture, shape (height, width, 3), blue green red, grabbed at an instant.

        Returns a table of one BLOB, which the next call overwrites; None when the object is not found.
        """
        assert pixels.shape == (*self._buffers.stamps.shape, 3), f"{pixels.shape} is another size"
        x, y = self.predict(at)
        is_patient = self._seen is not None and seconds_between(self._seen, at) <= self._patience_s
        limits = self._nearby if is_patient else self._everywhere
        around = grow(read_only(pixels), self._classes, x, y, self._color, self._around, limits, self._buffers)
        if around == NOT_FOUND:
            self.lost = True
            return None
        found = float(self._buffers.blob["x_px"][0]), float(self._buffers.blob["y_px"][0])
        self._move(*found, at, steady=not self.lost and math.dist((x, y), found) <= self._near_px)
        self.around = around
        return self._buffers.blob

    def _move(self, x: float, y: float, at: Instant, *, steady: bool) -> None:
        """Set place, velocity and instant; the velocity is zero unless the motion was steady."""
        t = seconds_between(self._seen, at) if steady and self._seen is not None else 0.0
        self._vx_px_s, self._vy_px_s = ((x - self._x_px) / t, (y - self._y_px) / t) if t > 0.0 else (0.0, 0.0)
        self._x_px, self._y_px, self._seen, self.lost = x, y, at, False
