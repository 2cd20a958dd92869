"""Kernels that draw things that move, each into a small window of the image.

A window is u0, v0, u1, v1 [px], the last two exclusive. Samples are the rays of a pixel: their offsets
within it and their times within the exposure, shape (16, 3) [px, px, s]. Every kernel gets the floor points
of ``background`` and the optical center, called eye. Bodies are rows of ``physics``.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.floor import FloatImage
from vision_core.geometry import Bytes, Floats
from vision_core.kernels import kernel

NOTHING, TOP, SIDE, FIRST_DOT = -1, 0, 1, 2
"""Materials of a prism: index into its colors."""
CORNERS = (3, 12, 15)
"""The samples that with sample 0 are the corners of the 4x4: where these agree the others do."""

LIGHT_X, LIGHT_Y, LIGHT_Z = -0.36, 0.22, 0.906
"""Unit vector to the lamps."""
AMBIENT, DIFFUSE, HIGHLIGHT, GLOSS = 0.55, 0.48, 80.0, 24.0
"""How a ball is lit: at least, by the lamps, the gleam in grey levels and how narrow it is."""


@kernel
def draw_shadow(
    pixels: Bytes, floor: FloatImage, window: NDArray[np.int64], base: Floats, tip: Floats,
    radius: float, softness: float, darkness: float,
) -> None:  # fmt: skip
    """Darken the floor under the way from base to tip, shape (2,) each, swept by a disc with a soft rim [m]."""
    ax, ay = tip[0] - base[0], tip[1] - base[1]
    length2 = max(ax * ax + ay * ay, 1e-12)
    for v in range(window[1], window[3]):
        for u in range(window[0], window[2]):
            dx, dy = floor[v + 1, u + 1, 0] - base[0], floor[v + 1, u + 1, 1] - base[1]
            share = min(max((dx * ax + dy * ay) / length2, 0.0), 1.0)
            away = math.hypot(dx - share * ax, dy - share * ay)
            depth = (radius + softness - away) / (2.0 * softness)
            if depth <= 0.0:
                continue
            depth = min(depth, 1.0)
            left = 1.0 - darkness * depth * depth * (3.0 - 2.0 * depth)
            for channel in range(3):
                pixels[v, u, channel] = np.uint8(pixels[v, u, channel] * left + 0.5)


@kernel
def draw_prism(
    pixels: Bytes, floor: FloatImage, light: FloatImage, window: NDArray[np.int64], eye: Floats, samples: Floats,
    body: Floats, radius: float, front: float, height: float, colors: Floats, dots: Floats,
) -> None:  # fmt: skip
    """Draw an upright cylinder, cut flat where its own x is front [m], with dots on its top.

    colors: of top, side and every dot, shape (2 + k, 3); dots: x, y, radius in the body's space, shape (k, 3) [m].
    """
    poses = np.empty((len(samples), 4))
    for k in range(len(samples)):
        angle = body[2] + body[5] * samples[k, 2]
        poses[k, 0] = body[0] + body[3] * samples[k, 2]
        poses[k, 1] = body[1] + body[4] * samples[k, 2]
        poses[k, 2], poses[k, 3] = math.cos(angle), math.sin(angle)
    lift = height / eye[2]
    for v in range(window[1], window[3]):
        for u in range(window[0], window[2]):
            first = _sampled(floor, u, v, 0, samples, poses, eye, lift, radius, front, dots)
            alike = True
            for k in CORNERS:
                if _sampled(floor, u, v, k, samples, poses, eye, lift, radius, front, dots) != first:
                    alike = False
                    break
            if alike:
                if first != NOTHING:
                    _blend(pixels, u, v, light[v, u], colors[first, 0], colors[first, 1], colors[first, 2], 1.0)
                continue
            blue = green = red = covered = 0.0
            for k in range(len(samples)):
                material = _sampled(floor, u, v, k, samples, poses, eye, lift, radius, front, dots)
                if material != NOTHING:
                    blue += colors[material, 0]
                    green += colors[material, 1]
                    red += colors[material, 2]
                    covered += 1.0
            if covered > 0.0:
                share = 1.0 / len(samples)
                _blend(pixels, u, v, light[v, u], blue * share, green * share, red * share, covered * share)


@kernel
def _sampled(
    floor: FloatImage, u: int, v: int, k: int, samples: Floats, poses: Floats, eye: Floats,
    lift: float, radius: float, front: float, dots: Floats,
) -> int:  # fmt: skip
    """What ray k of a pixel meets of a prism."""
    du, dv = 0.5 * samples[k, 0], 0.5 * samples[k, 1]
    row, left, right = floor[v + 1, u + 1], floor[v + 1, u], floor[v + 1, u + 2]
    above, below = floor[v, u + 1], floor[v + 2, u + 1]
    x = row[0] + du * (right[0] - left[0]) + dv * (below[0] - above[0])
    y = row[1] + du * (right[1] - left[1]) + dv * (below[1] - above[1])
    px, py, c, s = poses[k, 0], poses[k, 1], poses[k, 2], poses[k, 3]
    dx, dy = x + (eye[0] - x) * lift - px, y + (eye[1] - y) * lift - py
    tx, ty = c * dx + s * dy, c * dy - s * dx
    if tx < front and tx * tx + ty * ty < radius * radius:
        for j in range(len(dots)):
            if (tx - dots[j, 0]) ** 2 + (ty - dots[j, 1]) ** 2 < dots[j, 2] ** 2:
                return FIRST_DOT + j
        return TOP
    dx, dy = x - px, y - py
    return SIDE if meets_prism(c * dx + s * dy, c * dy - s * dx, tx, ty, radius, front) else NOTHING


@kernel
def meets_prism(x1: float, y1: float, x2: float, y2: float, radius: float, front: float) -> bool:
    """Does a line on the floor, in the prism's own space, meet its outline: a disc cut flat at x = front?"""
    dx, dy = x2 - x1, y2 - y1
    start, end = 0.0, 1.0
    if x1 >= front and x2 >= front:
        return False
    if x1 >= front:
        start = (front - x1) / dx
    elif x2 >= front:
        end = (front - x1) / dx
    length2 = dx * dx + dy * dy
    nearest = -(x1 * dx + y1 * dy) / length2 if length2 > 0.0 else 0.0
    nearest = min(max(nearest, start), end)
    return (x1 + nearest * dx) ** 2 + (y1 + nearest * dy) ** 2 < radius * radius


@kernel
def draw_ball(
    pixels: Bytes, floor: FloatImage, light: FloatImage, window: NDArray[np.int64], eye: Floats, samples: Floats,
    body: Floats, radius: float, color: Floats,
) -> None:  # fmt: skip
    """Draw a sphere that lies on the floor, lit by the lamps."""
    share = 1.0 / len(samples)
    for v in range(window[1], window[3]):
        for u in range(window[0], window[2]):
            row, left, right = floor[v + 1, u + 1], floor[v + 1, u], floor[v + 1, u + 2]
            above, below = floor[v, u + 1], floor[v + 2, u + 1]
            covered = lit = gleam = 0.0
            for k in range(len(samples)):
                du, dv = 0.5 * samples[k, 0], 0.5 * samples[k, 1]
                x = row[0] + du * (right[0] - left[0]) + dv * (below[0] - above[0])
                y = row[1] + du * (right[1] - left[1]) + dv * (below[1] - above[1])
                cx, cy = body[0] + body[3] * samples[k, 2], body[1] + body[4] * samples[k, 2]
                dx, dy, dz = x - eye[0], y - eye[1], -eye[2]
                ox, oy, oz = eye[0] - cx, eye[1] - cy, eye[2] - radius
                a, b = dx * dx + dy * dy + dz * dz, ox * dx + oy * dy + oz * dz
                inside = b * b - a * (ox * ox + oy * oy + oz * oz - radius * radius)
                if not inside > 0.0:
                    continue
                reach = -(b + math.sqrt(inside)) / a
                facing = (
                    (ox + reach * dx) * LIGHT_X + (oy + reach * dy) * LIGHT_Y + (oz + reach * dz) * LIGHT_Z
                ) / radius
                covered += share
                lit += share * (AMBIENT + DIFFUSE * max(facing, 0.0))
                gleam += share * HIGHLIGHT * max(facing, 0.0) ** GLOSS
            if covered > 0.0:
                bgr = color * lit + gleam
                _blend(pixels, u, v, light[v, u], bgr[0], bgr[1], bgr[2], covered)


@kernel
def _blend(pixels: Bytes, u: int, v: int, light: float, blue: float, green: float, red: float, covered: float) -> None:
    """Lay a color, already weighted by the covered share, over a pixel."""
    left = 1.0 - covered
    pixels[v, u, 0] = np.uint8(min(pixels[v, u, 0] * left + blue * light + 0.5, 255.0))
    pixels[v, u, 1] = np.uint8(min(pixels[v, u, 1] * left + green * light + 0.5, 255.0))
    pixels[v, u, 2] = np.uint8(min(pixels[v, u, 2] * left + red * light + 0.5, 255.0))
