"""Kernels: the color of a point that a ray meets. The light is soft, as many lamps make it.

Floor, lamps, shadows and the ball are colored as the simulated ceiling camera colors them. A side gets the more light
the more it is turned to the lamps.
"""

from typing import Any, TypeAlias

from vision_core.capture.synthetic import background
from vision_core.capture.synthetic.floor import WOOD, color_clutter, floor_material, shade_of
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
from vision_core.onboard.scene import Ground, Papers

_lamp_light: Any = kernel(background.lamp_light)

Row: TypeAlias = Any
"""A row of SOLID: its fields are attributes."""
TIP_RADII = 1.5
"""A body's shadow falls as if its top were at most so many radii high."""
SHADOW_X, SHADOW_Y = SHADOW_PER_HEIGHT


@kernel
def color_ball(color: Floats, ball: Floats, time: float, point: Point) -> None:
    """Fill in the color of a point of the ball at a time. ball: as in ``Scene``."""
    nx, ny, nz = point[0] - ball[0] - time * ball[2], point[1] - ball[1] - time * ball[3], point[2] - ball[4]
    factor, highlight = shade_ball((nx * LIGHT_X + ny * LIGHT_Y + nz * LIGHT_Z) / ball[4])
    for channel in range(3):
        color[channel] = factor * ball[5 + channel] + highlight


@kernel
def color_prism(
    color: Floats, solid: Row, papers: Papers, face: int, x: float, y: float, z: float, normal: tuple[float, float]
) -> None:  # fmt: skip
    """Fill in the color of a point of a solid; x, y: in its own space, z: height; normal: of its side, in the field."""
    if face == ON_TOP:
        first, end = solid.first_patch, solid.end_patch
        patch = patch_at(x, y, papers.patches[first:end], papers.corners, 0.0) - FIRST_PATCH
        for channel in range(3):
            color[channel] = papers.bgr[first + patch, channel] if patch >= 0 else solid.top_bgr[channel]
        return
    light = AMBIENT
    if face != BELOW:
        light += DIFFUSE * (0.5 + 0.5 * (normal[0] * LIGHT_X + normal[1] * LIGHT_Y))
    in_band = solid.band_low_m <= z < solid.band_high_m
    for channel in range(3):
        color[channel] = light * (solid.band_bgr[channel] if in_band else solid.side_bgr[channel])


@kernel
def color_floor_point(
    color: Floats, ground: Ground, casters: Floats, point: Point, time: float
) -> None:  # fmt: skip
    """Fill in the color of a point of the floor at a time. casters: ``Scene.shadow_casters``."""
    x, y = point[0], point[1]
    material = floor_material(ground.venue, x, y, ground.lines, ground.arcs)
    shade = shade_of(material, ground.venue, x, y)
    for channel in range(3):
        color[channel] = ground.colors[material, channel] * shade
    if material == WOOD:
        color_clutter(color, x, y, ground.clutter)
    if ground.venue.shadows > 0.0:
        light = _out_of_shadow(casters, ground.venue.shadows, x, y, time)
        for channel in range(3):
            color[channel] *= light


@kernel
def _out_of_shadow(casters: Floats, darkness: float, x: float, y: float, time: float) -> float:
    """The share of the light that the shadows of robots and ball leave at a point of the floor."""
    kept = 1.0
    for i in range(len(casters)):
        dx, dy = x - casters[i, 0] - time * casters[i, 2], y - casters[i, 1] - time * casters[i, 3]
        radius, top = casters[i, 4], min(casters[i, 5], TIP_RADII * casters[i, 4])
        softness = min(SHADOW_SOFTNESS_M, 0.5 * radius)
        reach = radius + softness + top
        if dx * dx + dy * dy < reach * reach:
            kept *= 1.0 - darkness * shadow_depth(dx, dy, top * SHADOW_X, top * SHADOW_Y, radius, softness)
    return kept


@kernel
def lamps_at(brightness: float, uneven_light: float, x: float, y: float) -> float:
    """Factor of the lamps' light over a point of the floor."""
    light: float = brightness * (1.0 + 0.5 * uneven_light * _lamp_light(x, y))
    return light
