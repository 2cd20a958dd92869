"""Follows one object from picture to picture by region growing."""

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
    """Which region is the object."""

    min_area_px: int
    max_area_px: int
    around: Table | None = None
    """Color that must surround it, a row of COLOR; None: not looked at."""
    min_around: float = 0.5
    """Least share of the surrounding pixels that have it."""
    gap_px: int = 2
    """Layers next to the region that are left out, since colors mix there."""
    ring_px: int = 2
    """Layers beyond that are looked at."""
    near_px: float = 40.0
    """Found farther from where it was predicted, the object is taken to be at rest again."""
    patience_s: float = 0.0
    """So long after it was seen last it is searched at most near_px away, so that no similar object is taken for it."""
    budget_px: int = 1_000_000
    """Limit of the pixels grown in one picture, in all regions together."""

    def row(self, search_px: int) -> Table:
        """As a table of one row; search_px: how far from the start rings are looked at."""
        limits = np.zeros(1, dtype=LIMITS)
        limits["search_px"], limits["step_px"] = search_px, step_for(self.min_area_px)
        limits["min_area_px"], limits["max_area_px"] = self.min_area_px, self.max_area_px
        limits["gap_px"], limits["ring_px"] = self.gap_px, 0 if self.around is None else self.ring_px
        limits["min_around"], limits["budget_px"] = self.min_around, self.budget_px
        return limits


class GrowingTracker:
    """Follows one object from picture to picture, in memory that is allocated once.

    The search starts where the object is predicted from its last two places, at first in the picture's middle. When a
    picture does not show the object it is lost, and the search covers the whole picture until it is found again: at
    once, or after ``patience_s``.
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
        """color: a row of COLOR; table: whose classes it names, not needed for a seed; start_px: where it is looked
        for first, x and y."""
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
        """The last picture did not show the object, or there was no picture."""
        self.around = 0.0
        """Share of its surroundings that have the color `around`; 1 when that is not looked at."""

    @property
    def last_px(self) -> tuple[float, float]:
        """Where the object was seen last, x and y."""
        return self._x_px, self._y_px

    def predict(self, at: Instant) -> tuple[float, float]:
        """Where the object should be at an instant, x and y [px]; its last place when it is lost."""
        if self.lost or self._seen is None:
            return self._x_px, self._y_px
        t = seconds_between(self._seen, at)
        return self._x_px + self._vx_px_s * t, self._y_px + self._vy_px_s * t

    def follow(self, pixels: Bytes, at: Instant) -> Table | None:
        """Find the object in a picture, shape (height, width, 3), blue green red, grabbed at an instant.

        Returns a table of one BLOB, the tracker's own: the next call overwrites it. None: the picture does not show it.
        """
        assert pixels.shape == (*self._buffers.stamps.shape, 3), f"{pixels.shape} is another size"
        x, y = self.predict(at)
        waiting = self._seen is not None and seconds_between(self._seen, at) <= self._patience_s
        limits = self._nearby if waiting else self._everywhere
        around = grow(read_only(pixels), self._classes, x, y, self._color, self._around, limits, self._buffers)
        if around == NOT_FOUND:
            self.lost = True
            return None
        found = float(self._buffers.blob["x_px"][0]), float(self._buffers.blob["y_px"][0])
        self._move(*found, at, steady=not self.lost and math.dist((x, y), found) <= self._near_px)
        self.around = around
        return self._buffers.blob

    def _move(self, x: float, y: float, at: Instant, *, steady: bool) -> None:
        t = seconds_between(self._seen, at) if steady and self._seen is not None else 0.0
        self._vx_px_s, self._vy_px_s = ((x - self._x_px) / t, (y - self._y_px) / t) if t > 0.0 else (0.0, 0.0)
        self._x_px, self._y_px, self._seen, self.lost = x, y, at, False
