"""Kernels: the picture of a scene through a mirror, ray by ray.

Each pixel has 16 rays with offsets in the picture and in time, those of the simulated ceiling camera: antialiasing,
soft focus and motion blur. A ray of the camera is reflected at the mirror (``mirror_shape.reflect``) and goes on as if
it came from the viewpoint, which is where it is intersected with everything in the scene.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.synthetic.floor import COLORS, HORIZON
from vision_core.geometry import Bytes, Floats
from vision_core.native.kernels import kernel
from vision_core.onboard import mirror_shape
from vision_core.onboard.azimuths import azimuths_of, find_candidates, places_of
from vision_core.onboard.prism_rays import MISSED, TIE_M, Point, hit_prism, hit_sphere
from vision_core.onboard.scene import Scene
from vision_core.onboard.shading import color_ball, color_floor_point, color_prism, color_room

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


@kernel
def trace(picture: Bytes, optics: Optics, samples: Floats, scene: Scene, dark: Floats) -> None:
    """Fill a picture, shape (height, width, 3), with the mean color of each pixel's rays.

    samples: offsets of a pixel's rays in the picture and in time, shape (n, 3) [px, px, s]; dark: blue, green, red of
    what is outside of the mirror.
    """
    height, width, _ = picture.shape
    places = places_of(scene.solids, scene.viewer, samples[:, 2])
    azimuths = azimuths_of(scene.solids, places)
    candidates = np.empty(len(azimuths), dtype=np.int64)
    reach_px = math.sqrt(2.0) * np.abs(samples[:, :2]).max()
    color, total, shade = np.zeros(3), np.zeros(3), np.empty(len(scene.ground.colors))
    weight = 1.0 / len(samples)
    corner = 0.25 * (height * height + width * width)
    for v in range(height):
        for u in range(width):
            up, left = 0.5 * (height - 1) - v, 0.5 * (width - 1) - u
            lens = 1.0 - optics.vignetting * (up * up + left * left) / corner
            away = math.sqrt(up * up + left * left)
            margin = math.asin(reach_px / away) if away > CENTER_PX else math.pi
            count = find_candidates(candidates, azimuths, math.atan2(left, up), margin)
            total[:] = 0.0
            for k in range(len(samples)):
                x, y = (up - samples[k, 1]) / optics.scale, (left - samples[k, 0]) / optics.scale
                if x * x + y * y > optics.rim_px * optics.rim_px:
                    for channel in range(3):
                        total[channel] += dark[channel]
                    continue
                _, _, _, dx, dy, dz = _reflect(x, y, optics.f_px, optics.a_m, optics.b_m)
                _look(color, dx, dy, dz, scene, candidates[:count], places[k], samples[k, 2], shade)
                for channel in range(3):
                    total[channel] += color[channel] * lens
            for channel in range(3):
                picture[v, u, channel] = np.uint8(min(total[channel] * weight + 0.5, 255.0))


@kernel
def _look(
    color: Floats, dx: float, dy: float, dz: float, scene: Scene, candidates: NDArray[np.int64], places: Floats,
    time: float, shade: Floats,
) -> None:  # fmt: skip
    """Fill in the color that a ray from the viewpoint meets; its direction is given in robot space.

    candidates: the solids that it may meet; shade: scratch.
    """
    viewer, eye_m = scene.viewer, scene.height_m
    # the nearest solid
    nearest, found, face, nx, ny = math.inf, -1, MISSED, 0.0, 0.0
    for i in candidates:
        solid = scene.solids[i]
        ox, oy, c, s = places[i, 0], places[i, 1], places[i, 2], places[i, 3]
        ex, ey = c * dx - s * dy, s * dx + c * dy
        t, met, mx, my = hit_prism(
            solid.round != 0, solid.half_length_m, solid.half_width_m, solid.front_m, solid.bottom_m, solid.top_m,
            eye_m, ox, oy, ex, ey, dz,
        )  # fmt: skip
        if t < nearest - TIE_M:
            nearest, found, face, nx, ny = t, i, met, mx, my
    # the ball
    heading = viewer[2] + time * viewer[5]
    c, s = math.cos(heading), math.sin(heading)
    eye = viewer[0] + time * viewer[3], viewer[1] + time * viewer[4], eye_m
    ray = c * dx - s * dy, s * dx + c * dy, dz
    ball = scene.ball
    center = ball[0] + time * ball[2], ball[1] + time * ball[3], ball[4]
    t_ball = hit_sphere(center, ball[4], eye, ray)
    # the floor
    t_floor = eye_m / -dz if dz < 0.0 else math.inf
    if t_ball < min(nearest, t_floor):
        color_ball(color, scene, center, _along(eye, ray, t_ball))
    elif nearest < t_floor:
        ox, oy, c, s = places[found, 0], places[found, 1], places[found, 2], places[found, 3]
        px, py = ox + nearest * (c * dx - s * dy), oy + nearest * (s * dx + c * dy)
        normal_x, normal_y = (
            places[found, 4] * nx - places[found, 5] * ny,
            places[found, 5] * nx + places[found, 4] * ny,
        )
        color_prism(color, scene, found, face, px, py, _along(eye, ray, nearest), normal_x, normal_y)
    else:
        t_room = min(
            (math.copysign(scene.ground.room[0], ray[0]) - eye[0]) / ray[0] if ray[0] != 0.0 else math.inf,
            (math.copysign(scene.ground.room[1], ray[1]) - eye[1]) / ray[1] if ray[1] != 0.0 else math.inf,
        )
        if t_floor < t_room:
            color_floor_point(color, scene, _along(eye, ray, t_floor), time, shade)
        else:
            color_room(color, scene, _along(eye, ray, t_room))


@kernel
def _along(eye: Point, ray: Point, t: float) -> Point:
    """A point of a ray."""
    return eye[0] + t * ray[0], eye[1] + t * ray[1], eye[2] + t * ray[2]
