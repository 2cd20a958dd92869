"""Kernels: the picture of a scene through a mirror, ray by ray.

Each pixel has 16 rays with offsets in the picture and in time, those of the simulated ceiling camera: antialiasing,
soft focus and motion blur. A ray of the camera is reflected at the mirror (``mirror_shape.reflect``) and goes on as if
it came from the viewpoint, which is where it is intersected with everything in the scene.

What is called for every ray gets the few arrays that it needs: a whole scene costs more to hand over than to look at.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.floor import COLORS, HORIZON
from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel
from vision_core.onboard import mirror_shape
from vision_core.onboard.azimuths import extents_of, find_candidates, places_of, shapes_of, viewpoints_of
from vision_core.onboard.prism_rays import MISSED, TIE_M, Point, hit_prism, hit_sphere
from vision_core.onboard.scene import Scene
from vision_core.onboard.shading import color_ball, color_floor_point, color_prism, lamps_at

Labels: TypeAlias = NDArray[np.int32]

_reflect: Any = kernel(mirror_shape.reflect)

DARK = COLORS[HORIZON]
"""What holds the mirror: around it the picture is dark."""
BALL, FLOOR, ROOM, OUTSIDE = -1, -2, -3, -4
"""Labels of what a ray meets, beside the rows of the scene's solids; OUTSIDE: it does not meet the mirror."""
CENTER_PX = 3.0
"""So near to the center of the picture, a pixel's rays go to all azimuths."""
ROUNDING = 1e-9


class Optics(NamedTuple):
    """Mirror and camera, for the kernels."""

    f_px: float
    a_m: float
    b_m: float
    scale: float
    """Pixels of the picture per pixel of equation 1."""
    rim_px: float
    """The mirror's rim [px of equation 1]."""
    vignetting: float


class Around(NamedTuple):
    """The viewer and what stands around it at the times of a pixel's rays; see ``azimuths``."""

    samples: Floats
    """Offsets of the rays in the picture and in time, shape (n, 3) [px, px, s]."""
    places: Floats
    shapes: Floats
    viewpoints: Floats
    ball: Floats
    room: Floats
    height_m: float


@kernel
def trace(picture: Bytes, optics: Optics, samples: Floats, scene: Scene, dark: Floats) -> None:
    """Fill a picture, shape (height, width, 3), with the mean color of each pixel's rays.

    samples: offsets of a pixel's rays in the picture and in time, shape (n, 3) [px, px, s]; dark: blue, green, red of
    what is outside of the mirror.
    """
    height, width, _ = picture.shape
    around = _around(samples, scene)
    extents = _extents(around, scene)
    candidates = np.empty(len(extents), dtype=np.int64)
    total, color = np.zeros(3), np.zeros(3)
    reach_px = math.sqrt(2.0) * np.abs(samples[:, :2]).max()
    corner = 0.25 * (height * height + width * width)
    for v in range(height):
        for u in range(width):
            up, left = 0.5 * (height - 1) - v, 0.5 * (width - 1) - u
            away = math.sqrt(up * up + left * left)
            margin = math.asin(reach_px / away) if away > CENTER_PX else math.pi
            near, far = _floor_m(away - reach_px, optics, scene), _floor_m(away + reach_px, optics, scene)
            count = find_candidates(candidates, extents, math.atan2(left, up), margin, near, far)
            total[:] = 0.0
            inside = _add_rays(total, color, up, left, optics, scene, around, candidates[:count])
            lens = (1.0 - optics.vignetting * away * away / corner) / len(samples)
            outside = 1.0 - inside / len(samples)
            for channel in range(3):
                level = lens * total[channel] + outside * dark[channel]
                picture[v, u, channel] = np.uint8(min(level + 0.5, 255.0))


@kernel
def label(labels: Labels, ranges: Floats, optics: Optics, scene: Scene) -> None:
    """What the ray through each pixel's center meets at mid-exposure, and how far from the viewpoint [m].

    labels, ranges: the results, shape (height, width); a label is a row of the scene's solids, or BALL, FLOOR, ROOM or
    OUTSIDE, where the range is inf.
    """
    height, width = labels.shape
    around = _around(np.zeros((1, 3)), scene)
    extents = _extents(around, scene)
    candidates = np.empty(len(extents), dtype=np.int64)
    for v in range(height):
        for u in range(width):
            x, y = (0.5 * (height - 1) - v) / optics.scale, (0.5 * (width - 1) - u) / optics.scale
            if x * x + y * y > optics.rim_px * optics.rim_px:
                labels[v, u], ranges[v, u] = OUTSIDE, math.inf
                continue
            _, _, _, dx, dy, dz = _reflect(x, y, optics.f_px, optics.a_m, optics.b_m)
            margin = ROUNDING if x * x + y * y > 0.0 else math.pi
            floor = _floor_m(optics.scale * math.hypot(x, y), optics, scene)
            near, far = (1.0 - ROUNDING) * floor, (1.0 + ROUNDING) * floor
            count = find_candidates(candidates, extents, math.atan2(y, x), margin, near, far)
            labels[v, u], ranges[v, u], _, _, _, _ = _first_hit(around, candidates[:count], 0, dx, dy, dz)


@kernel
def _around(samples: Floats, scene: Scene) -> Around:
    times = samples[:, 2].copy()
    viewpoints, shapes = viewpoints_of(scene.viewer, times), shapes_of(scene.solids)
    places = places_of(scene.solids, scene.viewer, times)
    return Around(samples, places, shapes, viewpoints, scene.ball, scene.ground.room, scene.height_m)


@kernel
def _extents(around: Around, scene: Scene) -> Floats:
    times = around.samples[:, 2].copy()
    return extents_of(scene.solids, around.places, around.viewpoints, times, scene.ball, scene.height_m)


@kernel
def _floor_m(radius_px: float, optics: Optics, scene: Scene) -> float:
    """How far from the viewer rays at a radius of the picture [px] meet the floor; inf: they do not."""
    radius = min(max(radius_px / optics.scale, 0.0), optics.rim_px)
    _, _, _, dx, _, dz = _reflect(radius, 0.0, optics.f_px, optics.a_m, optics.b_m)
    return scene.height_m * dx / -dz if dz < 0.0 else math.inf


@kernel
def _add_rays(
    total: Floats, color: Floats, up: float, left: float, optics: Optics, scene: Scene,
    around: Around, candidates: NDArray[np.int64],
) -> int:  # fmt: skip
    """Add the colors of a pixel's rays that meet the mirror to total; returns how many do. color: scratch."""
    ball, ground, inside = scene.ball, scene.ground, 0
    for k in range(len(around.samples)):
        x, y = (up - around.samples[k, 1]) / optics.scale, (left - around.samples[k, 0]) / optics.scale
        if x * x + y * y > optics.rim_px * optics.rim_px:
            continue
        inside += 1
        _, _, _, dx, dy, dz = _reflect(x, y, optics.f_px, optics.a_m, optics.b_m)
        met, t, face, nx, ny, point = _first_hit(around, candidates, k, dx, dy, dz)
        if met >= 0:
            place = around.places[k, met]
            own_x = place[0] + t * (place[2] * dx - place[3] * dy)
            own_y = place[1] + t * (place[3] * dx + place[2] * dy)
            normal = place[4] * nx - place[5] * ny, place[5] * nx + place[4] * ny
            color_prism(color, scene.solids[met], scene.papers, face, own_x, own_y, point[2], normal)
        elif met == BALL:
            color_ball(color, ball, around.samples[k, 2], point)
        elif met == FLOOR:
            color_floor_point(color, ground, scene.shadow_casters, point, around.samples[k, 2])
        else:
            for channel in range(3):
                color[channel] = ground.room[2 + channel]
        light = lamps_at(ground.brightness, ground.uneven_light, point[0], point[1])
        for channel in range(3):
            total[channel] += color[channel] * light
    return inside


@kernel
def _first_hit(
    around: Around, candidates: NDArray[np.int64], k: int, dx: float, dy: float, dz: float
) -> tuple[int, float, int, float, float, Point]:  # fmt: skip
    """What a ray meets first: label, distance, of a solid the face and the side's normal in its space, and the point.

    candidates: rows of the extents that it may meet; k: number of the ray in its pixel; dx, dy, dz: its direction, a
    unit vector in robot space.
    """
    shapes, places = around.shapes, around.places
    nearest, met, face, nx, ny = math.inf, ROOM, MISSED, 0.0, 0.0
    viewpoints, ball, time = around.viewpoints, around.ball, around.samples[k, 2]
    eye, c, s = (viewpoints[k, 0], viewpoints[k, 1], around.height_m), viewpoints[k, 2], viewpoints[k, 3]
    ray = c * dx - s * dy, s * dx + c * dy, dz
    for i in candidates:
        if i == len(shapes):
            t = hit_sphere((ball[0] + time * ball[2], ball[1] + time * ball[3], ball[4]), ball[4], eye, ray)
            if t < nearest:
                nearest, met = t, BALL
            continue
        # a solid, in its own space
        ox, oy, c, s = places[k, i, 0], places[k, i, 1], places[k, i, 2], places[k, i, 3]
        t, side, mx, my = hit_prism(shapes, i, around.height_m, ox, oy, c * dx - s * dy, s * dx + c * dy, dz)
        if t < nearest - TIE_M:
            nearest, met, face, nx, ny = t, i, side, mx, my
    if dz < 0.0 and around.height_m / -dz < nearest:
        nearest, met = around.height_m / -dz, FLOOR
    for axis in range(2):
        if ray[axis] != 0.0:
            t = (math.copysign(around.room[axis], ray[axis]) - eye[axis]) / ray[axis]
            if t < nearest:
                nearest, met = t, ROOM
    return met, nearest, face, nx, ny, (eye[0] + nearest * ray[0], eye[1] + nearest * ray[1], eye[2] + nearest * dz)
