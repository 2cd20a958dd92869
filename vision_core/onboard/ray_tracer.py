"""Kernels: the picture of a scene through a mirror, ray by ray.

Each pixel has 16 rays with offsets in the picture and in time, those of the simulated ceiling camera: antialiasing,
soft focus and motion blur. A ray of the camera is reflected at the mirror (``mirror_shape.reflect``) and goes on as if
it came from the viewpoint, which is where it is intersected with everything in the scene.

What is called for every ray gets the few arrays that it needs: a whole scene costs more to hand over than to look at.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.floor import COLORS, HORIZON
from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel
from vision_core.onboard import mirror_shape
from vision_core.onboard.azimuths import azimuths_of, find_candidates, places_of, shapes_of
from vision_core.onboard.prism_rays import MISSED, TIE_M, Point, hit_prism, hit_sphere
from vision_core.onboard.scene import Scene
from vision_core.onboard.shading import color_ball, color_floor_point, color_prism, lamps_at

_reflect: Any = kernel(mirror_shape.reflect)

DARK = COLORS[HORIZON]
"""What holds the mirror: around it the picture is dark."""
CENTER_PX = 3.0
"""So near to the center of the picture, a pixel's rays go to all azimuths."""


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
    """What stands around the viewer at the times of a pixel's rays; see ``azimuths``."""

    samples: Floats
    """Offsets of the rays in the picture and in time, shape (n, 3) [px, px, s]."""
    places: Floats
    shapes: Floats
    candidates: NDArray[np.int64]
    """Rows of the solids that the rays of one pixel may meet."""
    color: Floats
    """Scratch: of a ray, shape (3,)."""
    shade: Floats
    """Scratch: a factor for every material of the floor."""


@kernel
def trace(picture: Bytes, optics: Optics, samples: Floats, scene: Scene, dark: Floats) -> None:
    """Fill a picture, shape (height, width, 3), with the mean color of each pixel's rays.

    samples: offsets of a pixel's rays in the picture and in time, shape (n, 3) [px, px, s]; dark: blue, green, red of
    what is outside of the mirror.
    """
    height, width, _ = picture.shape
    places = places_of(scene.solids, scene.viewer, samples[:, 2])
    azimuths = azimuths_of(scene.solids, places)
    shapes, candidates = shapes_of(scene.solids), np.empty(len(azimuths), dtype=np.int64)
    total, color, shade = np.zeros(3), np.zeros(3), np.empty(len(scene.ground.colors))
    reach_px = math.sqrt(2.0) * np.abs(samples[:, :2]).max()
    corner = 0.25 * (height * height + width * width)
    for v in range(height):
        for u in range(width):
            up, left = 0.5 * (height - 1) - v, 0.5 * (width - 1) - u
            away = math.sqrt(up * up + left * left)
            margin = math.asin(reach_px / away) if away > CENTER_PX else math.pi
            count = find_candidates(candidates, azimuths, math.atan2(left, up), margin)
            total[:] = 0.0
            around = Around(samples, places, shapes, candidates[:count], color, shade)
            inside = _add_rays(total, up, left, optics, scene, around)
            lens = (1.0 - optics.vignetting * away * away / corner) / len(samples)
            outside = 1.0 - inside / len(samples)
            for channel in range(3):
                level = lens * total[channel] + outside * dark[channel]
                picture[v, u, channel] = np.uint8(min(level + 0.5, 255.0))


@kernel
def _add_rays(total: Floats, up: float, left: float, optics: Optics, scene: Scene, around: Around) -> int:
    """Add the colors of a pixel's rays that meet the mirror to total; returns how many do."""
    viewer, eye_m, ball, ground = scene.viewer, scene.height_m, scene.ball, scene.ground
    color, inside = around.color, 0
    for k in range(len(around.samples)):
        # the ray in robot space
        x, y = (up - around.samples[k, 1]) / optics.scale, (left - around.samples[k, 0]) / optics.scale
        if x * x + y * y > optics.rim_px * optics.rim_px:
            continue
        inside += 1
        _, _, _, dx, dy, dz = _reflect(x, y, optics.f_px, optics.a_m, optics.b_m)
        # the ray in the field
        time = around.samples[k, 2]
        heading = viewer[2] + time * viewer[5]
        c, s = math.cos(heading), math.sin(heading)
        eye = viewer[0] + time * viewer[3], viewer[1] + time * viewer[4], eye_m
        ray = c * dx - s * dy, s * dx + c * dy, dz
        # what it meets first: a solid, the ball, the floor or the room
        t_solid, found, face, nx, ny = _nearest_solid(around, k, eye_m, dx, dy, dz)
        center = ball[0] + time * ball[2], ball[1] + time * ball[3], ball[4]
        t_ball = hit_sphere(center, ball[4], eye, ray)
        t_floor = eye_m / -dz if dz < 0.0 else math.inf
        t = min(t_solid, t_ball, t_floor, _room_distance(ground.room, eye, ray))
        px, py, pz = eye[0] + t * ray[0], eye[1] + t * ray[1], eye_m + t * dz
        if t == t_solid:
            place = around.places[k, found]
            own_x = place[0] + t * (place[2] * dx - place[3] * dy)
            own_y = place[1] + t * (place[3] * dx + place[2] * dy)
            normal = place[4] * nx - place[5] * ny, place[5] * nx + place[4] * ny
            color_prism(color, scene.solids[found], scene.papers, face, own_x, own_y, pz, normal)
        elif t == t_ball:
            color_ball(color, ball, px - center[0], py - center[1], pz - center[2])
        elif t == t_floor:
            color_floor_point(color, around.shade, ground, scene.shadow_casters, px, py, time)
        else:
            for channel in range(3):
                color[channel] = ground.room[2 + channel]
        light = lamps_at(ground.brightness, ground.uneven_light, px, py)
        for channel in range(3):
            total[channel] += color[channel] * light
    return inside


@kernel
def _nearest_solid(
    around: Around, k: int, eye_m: float, dx: float, dy: float, dz: float
) -> tuple[float, int, int, float, float]:  # fmt: skip
    """Distance, row and face of the solid that a ray meets first, and the side's normal in the solid's space.

    k: number of the ray in its pixel; dx, dy, dz: its direction in robot space.
    """
    shapes, places, candidates = around.shapes, around.places, around.candidates
    nearest, found, face, nx, ny = math.inf, -1, MISSED, 0.0, 0.0
    for i in candidates:
        ox, oy, c, s = places[k, i, 0], places[k, i, 1], places[k, i, 2], places[k, i, 3]
        t, met, mx, my = hit_prism(shapes, i, eye_m, ox, oy, c * dx - s * dy, s * dx + c * dy, dz)
        if t < nearest - TIE_M:
            nearest, found, face, nx, ny = t, i, met, mx, my
    return nearest, found, face, nx, ny


@kernel
def _room_distance(room: Floats, eye: Point, ray: Point) -> float:
    """t where a ray meets a wall of the room."""
    t = math.inf
    for axis in range(2):
        if ray[axis] != 0.0:
            t = min(t, (math.copysign(room[axis], ray[axis]) - eye[axis]) / ray[axis])
    return t
