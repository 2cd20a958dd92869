"""Kernels that draw moving bodies and their shadows, each into a small window of the image.

A window is u0, v0, u1, v1 [px], the last two exclusive. Samples are the rays of a pixel: each one's offset from the
pixel's center and time within the exposure, shape (16, 3) [px, px, s]. ``floor`` holds the points where the pixels'
rays meet the floor (``Background.floor``); ``eye`` is the optical center. Bodies are rows as in ``physics``.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.floor import FloatImage
from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel

EDGE, NOTHING, TOP, SIDE, FIRST_PATCH = -2, -1, 0, 1, 2
"""What a pixel shows of a prism: an index into its colors, NOTHING, or EDGE: more than one material."""

LIGHT_X, LIGHT_Y, LIGHT_Z = -0.36, 0.22, 0.906
"""Unit vector to the lamps."""
AMBIENT, DIFFUSE, HIGHLIGHT, GLOSS = 0.55, 0.48, 80.0, 24.0
"""Shading of a ball (Phong): ambient and diffuse factor, highlight [grey levels] and its exponent."""


class Prism(NamedTuple):
    """An upright body with colored patches on its top, in its own space [m]."""

    radius: float
    """Radius of a round body, half the side of a square one."""
    front: float
    """x of the flat front of a round body; inf: it has none."""
    square: bool
    height: float
    colors: Floats
    """Blue, green, red of top, side and every patch, shape (2 + k, 3)."""
    patches: Floats
    """Of each patch x, y, radius (of a polygon: of the circle round it), first corner, end of its corners (exclusive).
    A circle has no corners: first and end are equal. Shape (k, 5)."""
    corners: Floats
    """Corners of all polygons, shape (c, 2)."""


@kernel
def draw_shadow(
    pixels: Bytes, floor: FloatImage, window: NDArray[np.int64], base: Floats, tip: Floats,
    radius: float, softness: float, darkness: float,
) -> None:  # fmt: skip
    """Darken the floor that a disc with a soft rim covers as it moves from base to tip, shape (2,) each [m]."""
    ax, ay = tip[0] - base[0], tip[1] - base[1]
    for v in range(window[1], window[3]):
        for u in range(window[0], window[2]):
            dx, dy = floor[v + 1, u + 1, 0] - base[0], floor[v + 1, u + 1, 1] - base[1]
            depth = shadow_depth(dx, dy, ax, ay, radius, softness)
            if not depth > 0.0:
                continue
            kept = 1.0 - darkness * depth
            for channel in range(3):
                pixels[v, u, channel] = np.uint8(pixels[v, u, channel] * kept + 0.5)


@kernel
def shadow_depth(dx: float, dy: float, ax: float, ay: float, radius: float, softness: float) -> float:
    """How deep in a shadow, 0..1, a point of the floor lies; (dx, dy) from the base, whose tip is at (ax, ay) [m]."""
    share = min(max((dx * ax + dy * ay) / max(ax * ax + ay * ay, 1e-12), 0.0), 1.0)
    dx, dy = dx - share * ax, dy - share * ay
    depth = (radius + softness - math.sqrt(dx * dx + dy * dy)) / (2.0 * softness)
    if not depth > 0.0:
        return 0.0
    depth = min(depth, 1.0)
    return depth * depth * (3.0 - 2.0 * depth)


@kernel
def draw_prism(
    pixels: Bytes, floor: FloatImage, light: FloatImage, window: NDArray[np.int64], eye: Floats, samples: Floats,
    body: Floats, prism: Prism,
) -> None:  # fmt: skip
    """Draw an upright prism with patches on its top.

    A pixel far from all edges needs one ray; a pixel near an edge gets the mean of its samples.
    """
    colors, radius = prism.colors, prism.radius
    poses = _poses(body, samples)
    # the pose at mid-exposure, and how far an edge may move on the floor within the exposure
    mid_pose = np.array([body[0], body[1], math.cos(body[2]), math.sin(body[2])])
    height_ratio = prism.height / eye[2]
    reach_px = np.abs(samples[:, :2]).max()
    smear = (math.hypot(body[3], body[4]) + abs(body[5]) * radius) * np.abs(samples[:, 2]).max()
    for v in range(window[1], window[3]):
        for u in range(window[0], window[2]):
            # one ray through the pixel's center, with a margin for all its samples
            x, y, ux, uy, vx, vy = pixel_on_floor(floor, u, v)
            margin = reach_px * math.sqrt(ux * ux + uy * uy + vx * vx + vy * vy) + smear
            material = _material(x, y, mid_pose, eye, height_ratio, prism, margin)
            if material == NOTHING:
                continue
            if material != EDGE:
                _blend(pixels, u, v, light[v, u], colors[material, 0], colors[material, 1], colors[material, 2], 1.0)
                continue
            # near an edge: every sample at its own offset and time
            blue = green = red = covered = 0.0
            for k in range(len(samples)):
                du, dv = samples[k, 0], samples[k, 1]
                material = _material(
                    x + du * ux + dv * vx, y + du * uy + dv * vy, poses[k], eye, height_ratio, prism, 0.0
                )
                if material != NOTHING:
                    blue += colors[material, 0]
                    green += colors[material, 1]
                    red += colors[material, 2]
                    covered += 1.0
            if covered > 0.0:
                weight = 1.0 / len(samples)
                _blend(pixels, u, v, light[v, u], blue * weight, green * weight, red * weight, covered * weight)


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
    """Where a pixel's ray meets the floor, and how that point moves with one pixel to the right and one down [m]."""
    here, left, right = floor[v + 1, u + 1], floor[v + 1, u], floor[v + 1, u + 2]
    above, below = floor[v, u + 1], floor[v + 2, u + 1]
    return (
        here[0], here[1],
        0.5 * (right[0] - left[0]), 0.5 * (right[1] - left[1]),
        0.5 * (below[0] - above[0]), 0.5 * (below[1] - above[1]),
    )  # fmt: skip


@kernel
def _material(x: float, y: float, pose: Floats, eye: Floats, height_ratio: float, prism: Prism, margin: float) -> int:
    """What the ray towards x, y on the floor meets of a prism; EDGE when a margin [m] might change the answer."""
    # the ray's points at the floor (px, py) and at the height of the top (tx, ty), in the prism's space
    c, s = pose[2], pose[3]
    dx, dy = x - pose[0], y - pose[1]
    px, py = c * dx + s * dy, c * dy - s * dx
    dx, dy = dx + (eye[0] - x) * height_ratio, dy + (eye[1] - y) * height_ratio
    tx, ty = c * dx + s * dy, c * dy - s * dx
    # it meets the top, nothing, or a side
    radius, front, square = prism.radius, prism.front, prism.square
    if _on_top(tx, ty, radius - margin, front - margin, square):
        return patch_at(tx, ty, prism.patches, prism.corners, margin)
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
    """Is a point inside the outline of the top?"""
    if square:
        return max(abs(x), abs(y)) < radius
    return x < front and x * x + y * y < radius**2


@kernel
def patch_at(x: float, y: float, patches: Floats, corners: Floats, margin: float) -> int:
    """Material at a point of the top: its patch, TOP when it has none, EDGE when a margin might change the answer.

    Later patches lie over earlier ones.
    """
    for above in range(len(patches)):
        j = len(patches) - 1 - above
        distance_squared = (x - patches[j, 0]) ** 2 + (y - patches[j, 1]) ** 2
        if distance_squared < (patches[j, 2] + margin) ** 2:
            first, last = int(patches[j, 3]), int(patches[j, 4])
            if first == last:
                return FIRST_PATCH + j if distance_squared < max(patches[j, 2] - margin, 0.0) ** 2 else EDGE
            depth = polygon_depth(x, y, corners, first, last)
            if depth > -margin:
                return FIRST_PATCH + j if depth > margin or margin == 0.0 else EDGE
    return TOP


@kernel
def polygon_depth(x: float, y: float, corners: Floats, first: int, last: int) -> float:
    """Signed distance [m] of a point from the rim of the polygon corners[first:last], positive inside."""
    nearest_squared, inside = np.inf, False
    x1, y1 = corners[last - 1, 0], corners[last - 1, 1]
    for k in range(first, last):
        x2, y2 = corners[k, 0], corners[k, 1]
        sx, sy, dx, dy = x2 - x1, y2 - y1, x - x1, y - y1
        along = min(max((dx * sx + dy * sy) / (sx * sx + sy * sy), 0.0), 1.0)
        nearest_squared = min(nearest_squared, (dx - along * sx) ** 2 + (dy - along * sy) ** 2)
        if (y1 > y) != (y2 > y) and dx < dy * sx / sy:
            inside = not inside
        x1, y1 = x2, y2
    return math.sqrt(nearest_squared) if inside else -math.sqrt(nearest_squared)


@kernel
def meets_body(x1: float, y1: float, x2: float, y2: float, radius: float, front: float, square: bool) -> bool:
    """Does a segment on the floor, in the body's own space, meet the body's outline?"""
    if square:
        return meets_square(x1, y1, x2, y2, radius)
    return meets_prism(x1, y1, x2, y2, radius, front)


@kernel
def meets_square(x1: float, y1: float, x2: float, y2: float, half: float) -> bool:
    """Does a segment meet an axis-aligned square round the origin? half: half its side. By the slab method."""
    if half <= 0.0:
        return False
    start, end = 0.0, 1.0
    for origin, delta in ((x1, x2 - x1), (y1, y2 - y1)):
        if delta == 0.0:
            if abs(origin) >= half:
                return False
            continue
        first, second = (-half - origin) / delta, (half - origin) / delta
        start, end = max(start, min(first, second)), min(end, max(first, second))
    return start < end or (start == end and max(abs(x1), abs(y1)) < half)


@kernel
def meets_prism(x1: float, y1: float, x2: float, y2: float, radius: float, front: float) -> bool:
    """Does a segment, in the body's own space, meet its outline: a disc cut flat at x = front?"""
    dx, dy = x2 - x1, y2 - y1
    # the part of the segment behind the front
    start, end = 0.0, 1.0
    if x1 >= front and x2 >= front:
        return False
    if x1 >= front:
        start = (front - x1) / dx
    elif x2 >= front:
        end = (front - x1) / dx
    # its point nearest to the center
    length_squared = dx * dx + dy * dy
    nearest = -(x1 * dx + y1 * dy) / length_squared if length_squared > 0.0 else 0.0
    nearest = min(max(nearest, start), end)
    return (x1 + nearest * dx) ** 2 + (y1 + nearest * dy) ** 2 < radius * radius


@kernel
def draw_ball(
    pixels: Bytes, floor: FloatImage, light: FloatImage, window: NDArray[np.int64], eye: Floats, samples: Floats,
    body: Floats, radius: float, color: Floats,
) -> None:  # fmt: skip
    """Draw a sphere that lies on the floor, shaded by the lamps (Phong)."""
    weight = 1.0 / len(samples)
    for v in range(window[1], window[3]):
        for u in range(window[0], window[2]):
            here_x, here_y, ux, uy, vx, vy = pixel_on_floor(floor, u, v)
            covered = brightness = highlight = 0.0
            for k in range(len(samples)):
                # the sample's point on the floor, and the ball's center at the sample's time
                x = here_x + samples[k, 0] * ux + samples[k, 1] * vx
                y = here_y + samples[k, 0] * uy + samples[k, 1] * vy
                cx, cy = body[0] + body[3] * samples[k, 2], body[1] + body[4] * samples[k, 2]
                # intersect the ray eye + t * d with the sphere
                dx, dy, dz = x - eye[0], y - eye[1], -eye[2]
                ox, oy, oz = eye[0] - cx, eye[1] - cy, eye[2] - radius
                a, b = dx * dx + dy * dy + dz * dz, ox * dx + oy * dy + oz * dz
                discriminant = b * b - a * (ox * ox + oy * oy + oz * oz - radius * radius)
                if not discriminant > 0.0:
                    continue
                t = -(b + math.sqrt(discriminant)) / a
                # cosine between the normal at that point and the light
                cosine = ((ox + t * dx) * LIGHT_X + (oy + t * dy) * LIGHT_Y + (oz + t * dz) * LIGHT_Z) / radius
                factor, gloss = shade_ball(cosine)
                covered += weight
                brightness += weight * factor
                highlight += weight * gloss
            if covered > 0.0:
                bgr = color * brightness + highlight
                _blend(pixels, u, v, light[v, u], bgr[0], bgr[1], bgr[2], covered)


@kernel
def shade_ball(cosine: float) -> tuple[float, float]:
    """Factor and highlight [grey levels] of a ball's color, by the cosine between its normal and the light (Phong)."""
    return AMBIENT + DIFFUSE * max(cosine, 0.0), HIGHLIGHT * max(cosine, 0.0) ** GLOSS


@kernel
def _blend(pixels: Bytes, u: int, v: int, light: float, blue: float, green: float, red: float, covered: float) -> None:
    """Blend a color over a pixel; the color is already multiplied by the covered fraction (premultiplied alpha)."""
    kept = 1.0 - covered
    pixels[v, u, 0] = np.uint8(min(pixels[v, u, 0] * kept + blue * light + 0.5, 255.0))
    pixels[v, u, 1] = np.uint8(min(pixels[v, u, 1] * kept + green * light + 0.5, 255.0))
    pixels[v, u, 2] = np.uint8(min(pixels[v, u, 2] * kept + red * light + 0.5, 255.0))
