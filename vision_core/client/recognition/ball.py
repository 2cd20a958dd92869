"""The ball in a picture: its color, connected in direction, in front of the nearest edges."""

import math
from functools import lru_cache

import numpy as np

from vision_core.client.recognition.geometry import PictureGeometry
from vision_core.client.recognition.palette import Surface
from vision_core.geometry import Bytes, Floats, Mask, frozen
from vision_core.models.mirror import MAX_PX
from vision_core.protocol.messages import HIDDEN, Ball

MIN_AREA_PX = 3.0
"""Smallest ball, in pixels of the paper's picture."""
RIM_PX = 2
"""How far blur mixes the ball's color with others [px of the picture]."""
GAP_DEG = 3
"""So many directions without a pixel of it part two balls."""
BEHIND_PX = 4.0
"""The ball covers the foot of what stands close behind it: it may reach so far beyond an edge [px of equation 1]."""


def ball_pixels(labels: Bytes) -> Mask:
    """Which pixels show the ball: those of its color, and the blurred rim around them, which is no floor yet.

    labels: Surface of every pixel, shape (height, width).
    """
    core = labels == Surface.BALL
    near = grown(core, RIM_PX)
    blurred = np.isin(labels, (Surface.YELLOW, Surface.GOAL_YELLOW, Surface.OTHER))
    return np.asarray(core | (near & blurred))


def grown(mask: Mask, reach_px: int) -> Mask:
    """The mask with all pixels that are so near to it along rows and columns, shape (height, width)."""
    for _ in range(reach_px):
        mask = np.pad(mask, 1)
        mask = mask[:-2] | mask[1:-1] | mask[2:]
        mask = mask[:, :-2] | mask[:, 1:-1] | mask[:, 2:]
    return mask


def find_ball(core: Mask, whole: Mask, edges_px: Floats, geometry: PictureGeometry, *, beyond: bool) -> Ball:
    """The largest region of the ball's color; HIDDEN when there is none.

    core, whole: pixels of its color, and with their blurred rim, shape (height, width): the rim belongs to its size,
    but may be partly that of something yellow behind it; edges_px: radius of the nearest edge of evenly spaced
    directions [px of equation 1, inf: nothing]; beyond: whether the ball may lie behind the edges.
    """
    radii, directions = polar_of(geometry)
    n = len(edges_px)
    place = np.flatnonzero(whole.reshape(-1))
    radius, direction = radii[place], directions[place]
    sector = np.rint(direction * (n / 360.0)).astype(np.intp) % n
    certain = core.reshape(-1)[place]
    reach = np.where(certain, np.inf, 0.0) if beyond else BEHIND_PX
    kept = (radius > geometry.nearest_px) & (radius < edges_px[sector] + reach) & (radius < geometry.farthest_px)
    radius, direction, certain = radius[kept], direction[kept], certain[kept]
    middle = _fullest_direction(direction[certain])
    if middle is None:
        return HIDDEN
    aside = (direction - middle[0] + 180.0) % 360.0 - 180.0
    inside = np.abs(aside) <= middle[1] + math.degrees(RIM_PX / (geometry.scale * max(radius.min(), 1.0)))
    radius, angle, certain = radius[inside], np.radians(aside[inside]), certain[inside]
    if len(radius) < max(MIN_AREA_PX * geometry.scale**2, 2.0):
        return HIDDEN
    along, across = radius * np.cos(angle), radius * np.sin(angle)
    away, side = float(along[certain].mean()), float(across[certain].mean())
    px = math.hypot(away, side)
    # a disc's half width is twice its standard deviation; a pixel's own width is taken out
    spread = np.mean(np.square((across - side) * away / px - (along - away) * side / px))
    half = 2.0 * math.sqrt(max(float(spread) - 1.0 / (12.0 * geometry.scale**2), 0.0))
    return as_told(px, middle[0] + math.degrees(math.atan2(side, away)), half, geometry)


def as_told(px: float, direction_deg: float, half_px: float, geometry: PictureGeometry) -> Ball:
    """As the protocol says it: the distance on the floor, whole pixels and degrees."""
    floor_mm = geometry.mirror.mm_from_px(px)
    told_px = geometry.mirror.px_from_mm(floor_mm * geometry.ball_shrink) if math.isfinite(floor_mm) else px
    size = 2.0 * math.degrees(math.asin(min(half_px / px, 1.0)))
    return Ball(min(int(told_px), MAX_PX), math.floor(direction_deg + 0.5) % 360, max(math.floor(size + 0.5), 1))


def _fullest_direction(directions_deg: Floats) -> tuple[float, float] | None:
    """Middle and half width [deg] of the run of directions that has the most pixels; None without any."""
    if not len(directions_deg):
        return None
    counts = np.bincount(directions_deg.astype(np.intp) % 360, minlength=360)
    taken = np.flatnonzero(counts)
    gaps = np.diff(np.append(taken, taken[0] + 360))
    breaks = np.flatnonzero(gaps > GAP_DEG)
    if not len(breaks):
        return 0.0, 180.0  # it is all around
    order = np.roll(taken, -(breaks[-1] + 1) % len(taken))
    order = np.where(order < order[0], order + 360, order)
    groups = np.split(order, np.flatnonzero(np.diff(order) > GAP_DEG) + 1)
    best = max(groups, key=lambda group: int(counts[group % 360].sum()))
    first, last = float(best[0]), float(best[-1] + 1)
    return 0.5 * (first + last), 0.5 * (last - first) + 0.01


@lru_cache(maxsize=8)
def polar_of(geometry: PictureGeometry) -> tuple[Floats, Floats]:
    """Radius [px of equation 1] and direction [deg] of every pixel, flat."""
    width, height = geometry.size_px
    columns, rows = np.meshgrid(np.arange(width, dtype=np.float64), np.arange(height, dtype=np.float64))
    radius, direction = geometry.px_from_pixel(columns.reshape(-1), rows.reshape(-1))
    return frozen(radius), frozen(direction)
