"""Edges in an on-board picture along rays from its center, to a part of a pixel: the foot of a target on the floor.

A ray's profile is the color along it, averaged over a few pixels across it. An edge is where the color changes fastest.
Directions are anticlockwise from the robot's heading, which points up in the picture; left is left.
"""

import math
from dataclasses import dataclass

import numpy as np

from vision_core.calibration.profiles import sampled
from vision_core.geometry import Bytes, Floats

STEP_PX = 0.25
ACROSS_PX = np.linspace(-1.5, 1.5, 7)
"""Rays beside each other that are averaged."""
KERNEL = np.convolve(np.ones(5), np.ones(5)) / 25.0
"""Smooths a profile by two pixels' widths: pixels and their interpolation leave one slope of an edge, not several."""
MARGIN = len(KERNEL)
"""Steps that a profile reaches beyond the radii that count."""
MIN_CHANGE = 8.0
"""Slope of the weakest edge [grey levels per pixel]."""
MIN_RADIUS_PX = 4.0
WIDE = 10
"""Steps to either side of an edge's middle that belong to it."""
APART_PX = 1.5
"""Edges of one ray are at least so far apart."""
CLICK_PX = 12.0
"""How far beside a click the edge is searched."""
FAR = 0.5
"""Share of its strength that an edge at the end of the reach loses against one at the click."""

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class RadialEdge:
    """One edge."""

    radius_px: float
    """From the picture's center."""
    direction_rad: float
    place_px: Point
    change: float
    """How fast the color changes [grey levels per pixel]."""


def middle_of(pixels: Bytes) -> Point:
    """The center of a picture, shape (height, width, 3), where nobody says another one."""
    height, width, _ = pixels.shape
    return (width - 1) / 2.0, (height - 1) / 2.0


def direction_of(center_px: Point, place_px: Point) -> float:
    """Direction of a place in the picture [rad]."""
    return math.atan2(center_px[0] - place_px[0], center_px[1] - place_px[1])


def edge_at_click(pixels: Bytes, center_px: Point, place_px: Point, reach_px: float = CLICK_PX) -> RadialEdge | None:
    """The edge on the ray through a click that is strong and near to it; None: there is none within reach."""
    radius = math.dist(center_px, place_px)
    edges = edges_along(pixels, center_px, direction_of(center_px, place_px), (radius - reach_px, radius + reach_px))

    def score(edge: RadialEdge) -> float:
        return edge.change * (1.0 - FAR * abs(edge.radius_px - radius) / reach_px)

    return max(edges, key=score, default=None)


def strongest_edge(
    pixels: Bytes, center_px: Point, direction_rad: float, between_px: tuple[float, float]
) -> RadialEdge | None:
    """The strongest edge in a direction between two radii; None: there is none."""
    edges = edges_along(pixels, center_px, direction_rad, between_px)
    return max(edges, key=lambda edge: edge.change, default=None)


def edges_along(
    pixels: Bytes, center_px: Point, direction_rad: float, between_px: tuple[float, float]
) -> list[RadialEdge]:
    """All edges in a direction between two radii, outward. pixels: shape (height, width, 3)."""
    return edges_of(profile_along(pixels, center_px, direction_rad, between_px), center_px)


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """The color along a ray."""

    direction_rad: float
    radii_px: Floats
    """Shape (n,)."""
    colors: Floats
    """Blue green red, smoothed, shape (n, 3); nan outside of the picture."""
    between_px: tuple[float, float]
    """Where edges count."""


def profile_along(pixels: Bytes, center_px: Point, direction_rad: float, between_px: tuple[float, float]) -> Profile:
    """The colors in a direction between two radii, and somewhat beyond. pixels: shape (height, width, 3)."""
    low, high = max(between_px[0], MIN_RADIUS_PX), between_px[1]
    margin = MARGIN * STEP_PX
    radii = np.arange(low - margin, max(high, low) + margin + STEP_PX, STEP_PX)
    forward = np.array([-math.sin(direction_rad), -math.cos(direction_rad)])
    across = np.array([-forward[1], forward[0]])
    places = np.asarray(center_px) + radii[:, None, None] * forward + ACROSS_PX[:, None] * across
    colors = np.stack([sampled(pixels[..., c].astype(np.float32), places).mean(axis=1) for c in range(3)], axis=-1)
    smooth = np.stack([np.convolve(colors[:, c], KERNEL, mode="same") for c in range(3)], axis=-1)
    return Profile(direction_rad, radii, smooth, (low, high))


def edges_of(profile: Profile, center_px: Point) -> list[RadialEdge]:
    """The edges of a profile, outward."""
    slopes = np.gradient(profile.colors, STEP_PX, axis=0)
    change = np.nan_to_num(np.sqrt((slopes**2).sum(axis=1)))
    change[: MARGIN // 2 + 1] = change[-MARGIN // 2 :] = 0.0  # there the kernel reaches beyond the profile
    x, y = center_px
    found = []
    for number in _peaks(change):
        radius = float(profile.radii_px[0]) + STEP_PX * _middle(change, number)
        if not profile.between_px[0] <= radius <= profile.between_px[1]:
            continue
        place = x - radius * math.sin(profile.direction_rad), y - radius * math.cos(profile.direction_rad)
        found.append(RadialEdge(radius, profile.direction_rad, place, float(change[number])))
    return found


def _peaks(change: Floats) -> list[int]:
    """Places of the local maxima, in their order; of two near each other the higher one."""
    inner = change[1:-1]
    peaks = np.flatnonzero((inner >= change[:-2]) & (inner > change[2:]) & (inner >= MIN_CHANGE)) + 1
    kept: list[int] = []
    for number in sorted(peaks.tolist(), key=lambda place: -change[place]):
        if all(abs(number - other) * STEP_PX >= APART_PX for other in kept):
            kept.append(number)
    return sorted(kept)


def _middle(change: Floats, peak: int) -> float:
    """Where the middle of a peak lies, as a place in change: its centroid, between the valleys beside it.

    Pixels and their interpolation move the highest place, but not the centroid.
    """
    first, last = peak, peak
    while first > 0 and peak - first < WIDE and change[first - 1] < change[first]:
        first -= 1
    while last < len(change) - 1 and last - peak < WIDE and change[last + 1] < change[last]:
        last += 1
    weights = change[first : last + 1] - max(change[first], change[last])
    weights = weights.clip(min=0.0) if weights.max() > 0.0 else np.ones_like(weights)
    return float(np.average(np.arange(first, last + 1), weights=weights))
