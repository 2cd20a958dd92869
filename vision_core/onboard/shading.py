"""Kernels: the color of a point that a ray meets. The light is soft, as many lamps make it.

Floor, lamps, shadows and the ball are colored as the simulated ceiling camera colors them. A side gets the more light
the more it is turned to the lamps.
"""

from typing import Any

from vision_core.capture.synthetic import background
from vision_core.capture.synthetic.floor import WOOD, color_clutter, floor_material, shade_materials
from vision_core.capture.synthetic.render import SHADOW_PER_HEIGHT, SHADOW_SOFTNESS_M
from vision_core.capture.synthetic.sprites import (
    AMBIENT,
    DIFFUSE,
    FIRST_PATCH,
    LIGHT_X,
    LIGHT_Y,
    LIGHT_Z,
    patch_at,
    shade_ball,
    shadow_depth,
)
from vision_core.geometry import Floats
from vision_core.native.kernels import kernel
from vision_core.onboard.prism_rays import BELOW, ON_TOP, Point
from vision_core.onboard.scene import Scene

_lamp_light: Any = kernel(background.lamp_light)

TIP_RADII = 1.5
"""A body's shadow falls as if its top were at most so many radii high."""
SHADOW_X, SHADOW_Y = SHADOW_PER_HEIGHT


@kernel
def color_ball(color: Floats, scene: Scene, center: Point, point: Point) -> None:
    """A point of the ball."""
    ball = scene.ball
    nx, ny, nz = point[0] - center[0], point[1] - center[1], point[2] - center[2]
    factor, highlight = shade_ball((nx * LIGHT_X + ny * LIGHT_Y + nz * LIGHT_Z) / ball[4])
    light = _light_at(scene, point)
    for channel in range(3):
        color[channel] = light * (factor * ball[5 + channel] + highlight)


@kernel
def color_prism(
    color: Floats, scene: Scene, number: int, face: int, px: float, py: float, point: Point, nx: float, ny: float
) -> None:  # fmt: skip
    """A point of a solid; px, py: in the solid's space; nx, ny: normal of the side in the field."""
    solid = scene.solids[number]
    light = _light_at(scene, point)
    if face == ON_TOP:
        first, end = solid.first_patch, solid.end_patch
        patch = patch_at(px, py, scene.patches[first:end], scene.corners, 0.0) - FIRST_PATCH
        for channel in range(3):
            bgr = scene.patch_bgr[first + patch, channel] if patch >= 0 else solid.top_bgr[channel]
            color[channel] = light * bgr
        return
    light *= AMBIENT if face == BELOW else AMBIENT + DIFFUSE * (0.5 + 0.5 * (nx * LIGHT_X + ny * LIGHT_Y))
    in_band = solid.band_low_m <= point[2] < solid.band_high_m
    for channel in range(3):
        color[channel] = light * (solid.band_bgr[channel] if in_band else solid.side_bgr[channel])


@kernel
def color_floor_point(color: Floats, scene: Scene, point: Point, time: float, shade: Floats) -> None:
    """A point of the floor. shade: scratch for a factor of every material."""
    ground = scene.ground
    x, y = point[0], point[1]
    material = floor_material(ground.venue, x, y, ground.lines, ground.arcs)
    shade_materials(shade, ground.venue, x, y)
    for channel in range(3):
        color[channel] = ground.colors[material, channel] * shade[material]
    if material == WOOD:
        color_clutter(color, x, y, ground.clutter)
    light = _shadow_at(scene, x, y, time) * _light_at(scene, point)
    for channel in range(3):
        color[channel] *= light


@kernel
def _shadow_at(scene: Scene, x: float, y: float, time: float) -> float:
    """The share of the light that the shadows of robots and ball leave at a point of the floor."""
    darkness, kept = scene.ground.venue.shadows, 1.0
    if darkness == 0.0:
        return kept
    for i in range(len(scene.solids)):
        solid = scene.solids[i]
        if solid.casts_shadow:
            dx, dy = x - solid.x_m - time * solid.vx_m_s, y - solid.y_m - time * solid.vy_m_s
            kept *= 1.0 - darkness * _depth_of(dx, dy, solid.half_length_m, solid.top_m)
    ball = scene.ball
    dx, dy = x - ball[0] - time * ball[2], y - ball[1] - time * ball[3]
    return kept * (1.0 - darkness * _depth_of(dx, dy, ball[4], 2.0 * ball[4]))


@kernel
def _depth_of(dx: float, dy: float, radius: float, height: float) -> float:
    """How deep in the shadow of a body a point of the floor lies, 0..1."""
    top = min(height, TIP_RADII * radius)
    softness = min(SHADOW_SOFTNESS_M, 0.5 * radius)
    reach = radius + softness + top
    if dx * dx + dy * dy > reach * reach:
        return 0.0
    return shadow_depth(dx, dy, top * SHADOW_X, top * SHADOW_Y, radius, softness)


@kernel
def color_room(color: Floats, scene: Scene, point: Point) -> None:
    """A point of the room's walls."""
    light = _light_at(scene, point)
    for channel in range(3):
        color[channel] = light * scene.ground.room[2 + channel]


@kernel
def _light_at(scene: Scene, point: Point) -> float:
    """Factor of the lamps' light at a point."""
    ground = scene.ground
    light: float = ground.brightness * (1.0 + 0.5 * ground.uneven_light * _lamp_light(point[0], point[1]))
    return light
