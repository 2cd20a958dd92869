"""Kernels that draw things that move, each into a small window of the image.

A window is u0, v0, u1, v1 [px], the last two exclusive. Samples are the rays of a pixel: their offsets
from its middle and their times within the exposure, shape (16, 3) [px, px, s]. Every kernel gets the floor points
of ``background`` and the optical center, called eye. Bodies are rows of ``physics``.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.floor import FloatImage
from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel

EDGE, NOTHING, TOP, SIDE, FIRST_PATCH = -2, -1, 0, 1, 2
"""Materials of a prism: index into its colors, none, or more than one in a pixel."""

LIGHT_X, LIGHT_Y, LIGHT_Z = -0.36, 0.22, 0.906
"""Unit vector to the lamps."""
AMBIENT, DIFFUSE, HIGHLIGHT, GLOSS = 0.55, 0.48, 80.0, 24.0
"""How a ball is lit: at least, by the lamps, the gleam in grey levels and how narrow it is."""


class Prism(NamedTuple):
    """An upright body and what is painted on its top, in its own space [m]."""

    radius: float
    """Of a round body, or half the side of a square one."""
    front: float
    """A round body is cut flat there; inf: it is not."""
    square: bool
    height: float
    colors: Floats
    """Of top, side and every patch, shape (2 + k, 3)."""
    patches: Floats
    """x, y, radius of each, or of the circle round a polygon, then its first corner and the one after its last, which
    are the same for a circle; shape (k, 5)."""
    corners: Floats
    """Of all polygons, shape (c, 2)."""


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
            dx, dy = dx - share * ax, dy - share * ay
            depth = (radius + softness - math.sqrt(dx * dx + dy * dy)) / (2.0 * softness)
            if not depth > 0.0:
                continue
            depth = min(depth, 1.0)
            left = 1.0 - darkness * depth * depth * (3.0 - 2.0 * depth)
            for channel in range(3):
                pixels[v, u, channel] = np.uint8(pixels[v, u, channel] * left + 0.5)


@kernel
def draw_prism(
    pixels: Bytes, floor: FloatImage, light: FloatImage, window: NDArray[np.int64], eye: Floats, samples: Floats,
    body: Floats, prism: Prism,
) -> None:  # fmt: skip
    """Draw an upright prism with patches on its top."""
    colors, radius = prism.colors, prism.radius
    poses = _poses(body, samples)
    still = np.array([body[0], body[1], math.cos(body[2]), math.sin(body[2])])
    lift = prism.height / eye[2]
    reach_px = np.abs(samples[:, :2]).max()
    smear = (math.hypot(body[3], body[4]) + abs(body[5]) * radius) * np.abs(samples[:, 2]).max()
    for v in range(window[1], window[3]):
        for u in range(window[0], window[2]):
            x, y, ux, uy, vx, vy = pixel_on_floor(floor, u, v)
            margin = reach_px * math.sqrt(ux * ux + uy * uy + vx * vx + vy * vy) + smear
            material = _material(x, y, still, eye, lift, prism, margin)
            if material == NOTHING:
                continue
            if material != EDGE:
                _blend(pixels, u, v, light[v, u], colors[material, 0], colors[material, 1], colors[material, 2], 1.0)
                continue
            blue = green = red = covered = 0.0
            for k in range(len(samples)):
                du, dv = samples[k, 0], samples[k, 1]
                material = _material(x + du * ux + dv * vx, y + du * uy + dv * vy, poses[k], eye, lift, prism, 0.0)
                if material != NOTHING:
                    blue += colors[material, 0]
                    green += colors[material, 1]
                    red += colors[material, 2]
                    covered += 1.0
            if covered > 0.0:
                share = 1.0 / len(samples)
                _blend(pixels, u, v, light[v, u], blue * share, green * share, red * share, covered * share)


@kernel
def _poses(body: Floats, samples: Floats) -> Floats:
    """x, y, cos, sin of a body at the time of every sample, shape (16, 4)."""
    poses = np.empty((len(samples), 4))
    for k in range(len(samples)):
        angle = body[2] + body[5] * samples[k, 2]
        poses[k, 0] = body[0] + body[3] * samples[k, 2]
        poses[k, 1] = body[1] + body[4] * samples[k, 2]
        poses[k, 2], poses[k, 3] = math.cos(angle), math.sin(angle)
    return poses


@kernel
def pixel_on_floor(floor: FloatImage, u: int, v: int) -> tuple[float, float, float, float, float, float]:
    """Where a pixel's ray meets the floor, and how that moves with one pixel to the right and down [m]."""
    here, left, right = floor[v + 1, u + 1], floor[v + 1, u], floor[v + 1, u + 2]
    above, below = floor[v, u + 1], floor[v + 2, u + 1]
    return (
        here[0], here[1],
        0.5 * (right[0] - left[0]), 0.5 * (right[1] - left[1]),
        0.5 * (below[0] - above[0]), 0.5 * (below[1] - above[1]),
    )  # fmt: skip


@kernel
def _material(x: float, y: float, pose: Floats, eye: Floats, lift: float, prism: Prism, margin: float) -> int:
    """What the ray that would meet the floor at x, y meets of a prism; EDGE where a margin [m] changes that."""
    c, s = pose[2], pose[3]
    dx, dy = x - pose[0], y - pose[1]
    px, py = c * dx + s * dy, c * dy - s * dx
    dx, dy = dx + (eye[0] - x) * lift, dy + (eye[1] - y) * lift
    tx, ty = c * dx + s * dy, c * dy - s * dx
    radius, front, square = prism.radius, prism.front, prism.square
    if _on_top(tx, ty, radius - margin, front - margin, square):
        return _patch_at(tx, ty, prism.patches, prism.corners, margin)
    if not meets_body(px, py, tx, ty, radius + margin, front + margin, square):
        return NOTHING
    if margin > 0.0 and (
        _on_top(tx, ty, radius + margin, front + margin, square)
        or not meets_body(px, py, tx, ty, radius - margin, front - margin, square)
    ):
        return EDGE
    return SIDE


@kernel
def _on_top(x: float, y: float, radius: float, front: float, square: bool) -> bool:
    if square:
        return max(abs(x), abs(y)) < radius
    return x < front and x * x + y * y < radius**2


@kernel
def _patch_at(x: float, y: float, patches: Floats, corners: Floats, margin: float) -> int:
    """The patch at a point of the top, TOP for none, EDGE where a margin changes that."""
    for j in range(len(patches)):
        gap2 = (x - patches[j, 0]) ** 2 + (y - patches[j, 1]) ** 2
        if gap2 < (patches[j, 2] + margin) ** 2:
            first, last = int(patches[j, 3]), int(patches[j, 4])
            if first == last:
                return FIRST_PATCH + j if gap2 < max(patches[j, 2] - margin, 0.0) ** 2 else EDGE
            depth = polygon_depth(x, y, corners, first, last)
            if depth > -margin:
                return FIRST_PATCH + j if depth > margin or margin == 0.0 else EDGE
    return TOP


@kernel
def polygon_depth(x: float, y: float, corners: Floats, first: int, last: int) -> float:
    """How far a point lies inside of the polygon of some corners: the distance to its rim, negative outside."""
    nearest2, inside = np.inf, False
    x1, y1 = corners[last - 1, 0], corners[last - 1, 1]
    for k in range(first, last):
        x2, y2 = corners[k, 0], corners[k, 1]
        sx, sy, dx, dy = x2 - x1, y2 - y1, x - x1, y - y1
        along = min(max((dx * sx + dy * sy) / (sx * sx + sy * sy), 0.0), 1.0)
        nearest2 = min(nearest2, (dx - along * sx) ** 2 + (dy - along * sy) ** 2)
        if (y1 > y) != (y2 > y) and dx < dy * sx / sy:
            inside = not inside
        x1, y1 = x2, y2
    return math.sqrt(nearest2) if inside else -math.sqrt(nearest2)


@kernel
def meets_body(x1: float, y1: float, x2: float, y2: float, radius: float, front: float, square: bool) -> bool:
    """Does a line on the floor, in the body's own space, meet its outline?"""
    if square:
        return meets_square(x1, y1, x2, y2, radius)
    return meets_prism(x1, y1, x2, y2, radius, front)


@kernel
def meets_square(x1: float, y1: float, x2: float, y2: float, half: float) -> bool:
    """Does a line meet the upright square of a half side round the origin? By cutting it with both strips."""
    if half <= 0.0:
        return False
    start, end = 0.0, 1.0
    for place, way in ((x1, x2 - x1), (y1, y2 - y1)):
        if way == 0.0:
            if abs(place) >= half:
                return False
            continue
        one, other = (-half - place) / way, (half - place) / way
        start, end = max(start, min(one, other)), min(end, max(one, other))
    return start < end or (start == end and max(abs(x1), abs(y1)) < half)


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
            here_x, here_y, ux, uy, vx, vy = pixel_on_floor(floor, u, v)
            covered = lit = gleam = 0.0
            for k in range(len(samples)):
                x = here_x + samples[k, 0] * ux + samples[k, 1] * vx
                y = here_y + samples[k, 0] * uy + samples[k, 1] * vy
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
