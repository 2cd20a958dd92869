"""The simulated on-board picture (PSLV paper, figure 6), drawn from the content of a ``see`` message.

The image of an omnidirectional camera: the robot is in the center, its heading points up, left is left. The floor
reaches from the robot to the nearest edge of each direction; beyond it the edge's color fades with the distance,
because what is behind an edge is unknown. Outside of the mirror's horizon there is nothing.

Only NumPy is needed, so that a client can draw what it receives.
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.client.view import View
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.models.mirror import Mirror
from vision_core.protocol.messages import NOTHING_PX
from vision_core.protocol.options import Options
from vision_core.types.edges import Rgb, all_letters

FloatImage: TypeAlias = NDArray[np.float32]

WIDTH_PX, HEIGHT_PX = 320, 240
MARGIN_PX = 4.0
OVERSAMPLING = 2
"""Drawn with so many times the resolution, then averaged: smooth edges."""
MAX_STEP = 0.15
"""Neighbors of one type whose radii differ by less than this fraction are one edge, and joined by a line."""
FADE_LENGTH, DIMMEST = 0.5, np.float32(0.35)
"""Beyond an edge its color fades with this length, a fraction of the horizon, to this share of its light."""
RING_MM = 500.0
"""Between the rings on the floor."""
MIN_RING_GAP_PX = 4.0
"""Rings end where they would be closer than this."""
BODY_MM = 90.0
"""Radius of the own robot."""
BODY_GAP_PX = 1.5
"""It is drawn so much smaller, so that there is floor before the nearest edge [px of the picture]."""

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
    canvas = _canvas(mirror, scale)
    sectors = _sectors(mirror, scale, clockwise, len(letters), fov_deg)
    start, slope = _edge_lines(np.asarray(radii_px, dtype=np.float32), letters)
    half = sectors.half
    beyond = canvas.radius - (start[half] + slope[half] * sectors.share)
    tones = np.array([colors.get(letter, UNDEFINED_COLOR) for letter in letters], dtype=np.float32)
    light = DIMMEST + (1.0 - DIMMEST) * np.exp(np.maximum(beyond, 0.0) * (-1.0 / (FADE_LENGTH * mirror.horizon_px)))
    fine = np.take(np.stack([tones, np.roll(tones, -1, axis=0)], axis=1).reshape(-1, 3), half, axis=0)
    fine *= light[..., None]
    np.copyto(fine, canvas.floor, where=(beyond < 0.0)[..., None])
    if ball is not None:
        _paint(fine, canvas, _ball_disc(ball, scale, clockwise), BALL)
    fine[sectors.dark] = DARK
    body_px = mirror.px_from_mm(BODY_MM) * scale - BODY_GAP_PX
    _paint(fine, canvas, (0.0, 0.0, body_px), BODY)
    _paint(fine, canvas, (0.0, 0.6 * body_px, 0.16 * body_px), FRONT)
    picture = np.full((HEIGHT_PX * WIDTH_PX, 3), DARK, dtype=np.uint8)
    picture[canvas.pixels] = fine.sum(axis=0) * (1.0 / len(fine)) + 0.5
    return picture.reshape(HEIGHT_PX, WIDTH_PX, 3)


def draw_view(view: View, mirror: Mirror, options: Options) -> Bytes:
    """Draw a client's view: red green blue, shape (240, 320, 3). mirror, options: those of its session."""
    ball = view.ball
    whole_deg = ball.size_deg * (2.0 if options.size == "half" else 1.0)
    return draw_panorama(
        np.where(view.px < 0, NOTHING_PX, view.px).astype(np.float64),
        "".join(view.letters.tolist()),
        None if ball.hidden else (float(ball.px), float(ball.direction_deg), whole_deg),
        mirror,
        fov_deg=(options.fov_deg, options.center_deg),
        clockwise=options.sense == "cw",
    )


class _Canvas(NamedTuple):
    """The pixels within the horizon, each with its fine pixels, 4 of them; all of shape (4, n) but pixels."""

    pixels: NDArray[np.intp]
    """Their places in the flat picture, shape (n,)."""
    left: FloatImage
    """Distance from the picture's center to the left [px]."""
    up: FloatImage
    radius: FloatImage
    """R [px of the mirror's image]."""
    floor: FloatImage
    """Color of the floor, shape (4, n, 3)."""


class _Sectors(NamedTuple):
    """Where the fine pixels lie between the directions, shape (4, n)."""

    half: NDArray[np.int32]
    """Twice the number of the direction before it, plus one where the next one is nearer."""
    share: FloatImage
    """Fraction of the way from the one to the other."""
    dark: Mask
    """Beyond the horizon, or out of view."""


@lru_cache(maxsize=8)
def _canvas(mirror: Mirror, scale: float) -> _Canvas:
    x = (np.arange(WIDTH_PX * OVERSAMPLING) + 0.5) / OVERSAMPLING - WIDTH_PX / 2.0
    y = (np.arange(HEIGHT_PX * OVERSAMPLING) + 0.5) / OVERSAMPLING - HEIGHT_PX / 2.0
    shape = (HEIGHT_PX, OVERSAMPLING, WIDTH_PX, OVERSAMPLING)
    left, up = (
        plane.reshape(shape).transpose(1, 3, 0, 2).reshape(OVERSAMPLING**2, -1) for plane in np.meshgrid(-x, -y)
    )
    pixels = np.flatnonzero((np.hypot(left, up) <= mirror.horizon_px * scale).any(axis=0))
    left, up = left[:, pixels], up[:, pixels]
    radius = np.hypot(left, up) / scale
    table = _floor_table(mirror)
    floor = table[np.minimum((radius * 10.0).astype(np.int32), len(table) - 1)]
    return _Canvas(pixels, *(plane.astype(np.float32) for plane in (left, up, radius, floor)))


@lru_cache(maxsize=8)
def _sectors(mirror: Mirror, scale: float, clockwise: bool, count: int, fov_deg: tuple[float, float]) -> _Sectors:
    canvas = _canvas(mirror, scale)
    width, center = fov_deg
    turn = np.degrees(np.arctan2(-canvas.left if clockwise else canvas.left, canvas.up, dtype=np.float64))
    place = ((turn - (center - width / 2.0)) % 360.0) / (width / count)
    sector = np.minimum(place.astype(np.int32), count - 1)
    share = place - sector
    if width < 360.0:
        share[sector == count - 1] = 0.0  # the last direction has no next one
    dark = (canvas.radius > mirror.horizon_px) | (place >= count)
    return _Sectors(2 * sector + (share >= 0.5), share.astype(np.float32), dark)


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


def _edge_lines(radii_px: FloatImage, letters: str) -> tuple[FloatImage, FloatImage]:
    """The edge's radius over each half of a sector as a line: its value at share 0, and its slope; shape (2 n,).

    Interpolated along one edge, a step between two edges. R was cut to an integer, so the expected value is R + 1/2.
    """
    here = radii_px + np.float32(0.5)
    there = np.roll(here, -1)
    types = np.array(list(letters))
    joined = (types == np.roll(types, -1)) & (np.abs(there - here) <= MAX_STEP * np.minimum(here, there))
    slope = np.where(joined, there - here, np.float32(0.0))
    return np.column_stack([here, np.where(joined, here, there)]).reshape(-1), np.repeat(slope, 2)


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


def _paint(fine: FloatImage, canvas: _Canvas, disc: tuple[float, float, float], color: Rgb) -> None:
    """Draw a disc into the fine pixels. disc: left, up and radius [px of the picture]."""
    left, up, radius = disc
    inside = np.square(canvas.left - np.float32(left)) + np.square(canvas.up - np.float32(up)) <= radius * radius
    fine[inside] = color
