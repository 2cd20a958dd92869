"""The simulated on-board picture (PSLV paper, figure 6), drawn from the content of a ``see`` message.

The image of an omnidirectional camera: the robot is in the center, its heading points up, left is left. The floor
reaches from the robot to the nearest edge of each direction; beyond it the edge's color fades with the distance,
because what is behind an edge is unknown. Outside of the mirror's horizon there is nothing.

Only NumPy is needed, so that a client can draw what it receives.
"""

import math
from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats
from vision_core.models.mirror import Mirror
from vision_core.types.edges import Rgb, all_letters

WIDTH_PX, HEIGHT_PX = 320, 240
MARGIN_PX = 4.0
OVERSAMPLING = 2
"""Drawn with so many times the resolution, then averaged: smooth edges."""
MAX_STEP = 0.15
"""Neighbors of one type whose radii differ by less than this fraction are one edge, and joined by a line."""
FADE_LENGTH = 0.5
"""Beyond an edge its color fades with this length, a fraction of the horizon."""
RING_MM = 500.0
"""Between the rings on the floor."""
MIN_RING_GAP_PX = 4.0
"""Rings end where they would be closer than this."""
BODY_MM = 90.0
"""Radius of the own robot as it is drawn."""

COLORS: Mapping[str, Rgb] = {
    chr(ord(letter.default) + offset): letter.color for letter in all_letters() for offset in range(letter.count)
}
"""By the default letter of each edge type."""
UNDEFINED_COLOR: Rgb = (255, 0, 255)
"""Of a letter without a color: loud, so that it is noticed."""
FLOOR, RING, DARK = (46, 122, 66), (84, 150, 98), (16, 18, 22)
BALL, BODY, FRONT = (248, 122, 30), (74, 78, 86), (238, 240, 244)


def draw_panorama(
    radii_px: Floats,
    letters: str,
    ball: tuple[float, float, float] | None,
    mirror: Mirror,
    *,
    fov_deg: tuple[float, float] = (360.0, 180.0),
    clockwise: bool = False,
    colors: Mapping[str, Rgb] = COLORS,
) -> Bytes:
    """Draw one view: red green blue, shape (240, 320, 3).

    radii_px: R of each direction as received, shape (n,); letters: their types, n characters; ball: distance [px],
    direction and whole azimuth [deg], or None; mirror: of equation 1, for the horizon, the rings and the own body;
    fov_deg: width and center of the n directions, which are anticlockwise unless clockwise. Raises ValueError
    unless there is a letter for every radius.
    """
    if len(radii_px) != len(letters) or not letters:
        raise ValueError(
            f"{len(radii_px)} radii and {len(letters)} letters: one letter for each of at least one radius"
        )
    scale = min(1.0, (HEIGHT_PX / 2.0 - MARGIN_PX) / mirror.horizon_px)
    radius, turn = _polar(scale, clockwise)
    sector, share, seen = _sectors(turn, len(letters), fov_deg)
    edge = _edge_radii(np.asarray(radii_px, dtype=np.float64), letters, sector, share)
    nearest = np.where(share < 0.5, sector, (sector + 1) % len(letters))
    tones = np.array([colors.get(letter, UNDEFINED_COLOR) for letter in letters])
    beyond = radius - edge
    light = 0.35 + 0.65 * np.exp(-np.maximum(beyond, 0.0) / (FADE_LENGTH * mirror.horizon_px))
    picture = np.where((beyond < 0.0)[..., None], _floor(radius, mirror), tones[nearest] * light[..., None])
    if ball is not None:
        _paint(picture, *_ball_disc(ball, scale, clockwise), BALL)
    picture[(radius > mirror.horizon_px) | ~seen] = DARK
    body_px = mirror.px_from_mm(BODY_MM) * scale
    _paint(picture, 0.0, 0.0, body_px, BODY)
    _paint(picture, 0.0, 0.6 * body_px, 0.16 * body_px, FRONT)
    shape = (HEIGHT_PX, OVERSAMPLING, WIDTH_PX, OVERSAMPLING, 3)
    return np.asarray(picture.reshape(shape).mean(axis=(1, 3)) + 0.5, dtype=np.uint8)


@lru_cache(maxsize=8)
def _plane() -> tuple[Floats, Floats]:
    """Distance of each fine pixel from the picture's center, to the left and up [px]."""
    x = (np.arange(WIDTH_PX * OVERSAMPLING) + 0.5) / OVERSAMPLING - WIDTH_PX / 2.0
    y = (np.arange(HEIGHT_PX * OVERSAMPLING) + 0.5) / OVERSAMPLING - HEIGHT_PX / 2.0
    left, down = np.meshgrid(-x, y)
    return left, -down


@lru_cache(maxsize=8)
def _polar(scale: float, clockwise: bool) -> tuple[Floats, Floats]:
    """R [px of the mirror's image] and direction [deg, 0..360] of each fine pixel."""
    left, up = _plane()
    turn = np.degrees(np.arctan2(-left if clockwise else left, up)) % 360.0
    return np.hypot(left, up) / scale, turn


@lru_cache(maxsize=8)
def _floor_table(mirror: Mirror) -> Floats:
    """The floor's color at each R, in tenths of a pixel."""
    steps = np.arange(math.ceil(mirror.horizon_px) * 10 + 1) / 10.0
    table = np.tile(np.array(FLOOR, dtype=np.float64), (len(steps), 1))
    ring = 1
    while (at := mirror.px_from_mm(ring * RING_MM)) - mirror.px_from_mm((ring - 1) * RING_MM) > MIN_RING_GAP_PX:
        share = np.clip(1.2 - np.abs(steps - at), 0.0, 1.0)[:, None]
        table += share * (np.array(RING) - np.array(FLOOR))
        ring += 1
    return table


def _floor(radius: Floats, mirror: Mirror) -> Floats:
    table = _floor_table(mirror)
    return table[np.minimum((radius * 10.0).astype(np.int32), len(table) - 1)]


def _sectors(
    turn: Floats, count: int, fov_deg: tuple[float, float]
) -> tuple[NDArray[np.int32], Floats, NDArray[np.bool_]]:
    """Of each fine pixel: the direction before it, its fraction of the way to the next one, whether it is in view."""
    width, center = fov_deg
    step = width / count
    place = ((turn - (center - width / 2.0)) % 360.0) / step
    sector = np.minimum(place.astype(np.int32), count - 1)
    share = place - sector
    if width < 360.0:
        share[sector == count - 1] = 0.0  # the last direction has no next one
    return sector, share, place < count


def _edge_radii(radii_px: Floats, letters: str, sector: NDArray[np.int32], share: Floats) -> Floats:
    """The edge's radius at each fine pixel: interpolated along one edge, a step between two edges.

    R was cut to an integer, so the expected value is R + 1/2.
    """
    here = radii_px + 0.5
    there = np.roll(here, -1)
    types = np.array(list(letters))
    joined = (types == np.roll(types, -1)) & (np.abs(there - here) <= MAX_STEP * np.minimum(here, there))
    step = np.where(joined, there - here, 0.0)
    straight = here[sector] + step[sector] * share
    nearest = np.where(share < 0.5, here[sector], there[sector])
    return np.where(joined[sector], straight, nearest)


def _ball_disc(ball: tuple[float, float, float], scale: float, clockwise: bool) -> tuple[float, float, float]:
    """Left, up and radius of the ball's disc [px of the picture]."""
    distance, direction, size = ball
    away = (distance + 0.5) * scale
    angle = math.radians(-direction if clockwise else direction)
    return (
        away * math.sin(angle),
        away * math.cos(angle),
        max(away * math.sin(math.radians(min(size, 180.0) / 2.0)), 2.0),
    )


def _paint(picture: Floats, left: float, up: float, radius: float, color: Rgb) -> None:
    """Draw a disc around a point into the picture. left, up, radius: [px of the picture]."""
    lefts, ups = _plane()
    rows = slice(*_window(HEIGHT_PX / 2.0 - up, radius, HEIGHT_PX))
    columns = slice(*_window(WIDTH_PX / 2.0 - left, radius, WIDTH_PX))
    inside = np.hypot(lefts[rows, columns] - left, ups[rows, columns] - up) <= radius
    picture[rows, columns][inside] = color


def _window(center: float, radius: float, length: int) -> tuple[int, int]:
    first, last = math.floor((center - radius) * OVERSAMPLING), math.ceil((center + radius) * OVERSAMPLING)
    return min(max(first, 0), length * OVERSAMPLING), min(max(last, 0), length * OVERSAMPLING)
