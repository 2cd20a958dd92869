"""Kernels that render the static scene: floor, lines, walls, goals and clutter."""

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats
from vision_core.native.kernels import kernel

FloatImage: TypeAlias = NDArray[np.float32]

GRID = 4
"""Rays per pixel and axis."""
FOOTPRINT_PX = 1.5
"""Width of the area that a pixel's rays cover: wider than the pixel, since a lens blurs."""
HEIGHT_STEPS = 8
"""A ray is tested against walls and goals at this many steps of height, from their top to the floor."""

NOTHING, WALL, GOAL_LEFT, GOAL_RIGHT = range(4)
CARPET, LINE, WOOD, BOARD_TOP, BOARD_FACE, NET_LEFT, NET_RIGHT, HORIZON = range(8)
COLORS = np.array(
    [
        [50, 105, 40],  # carpet
        [228, 236, 232],  # paint of the lines
        [110, 148, 178],  # wooden floor beside the field
        [222, 226, 228],  # top of walls and goals
        [176, 184, 186],  # face of walls
        [84, 60, 52],  # net of the left goal, darker than any marker
        [54, 76, 84],  # net of the right goal
        [18, 18, 18],  # above the horizon
    ],
    dtype=np.float64,
)
"""Blue, green, red of every material, before light and noise."""

RECTANGLE, DISC = range(2)
CLUTTER_COLUMNS = 10
"""An item of clutter is a row: kind, x, y, cos, sin, half length (or radius), half width, blue, green, red."""


class Venue(NamedTuple):
    """Dimensions of field, walls and goals, for the kernels [m]."""

    half_x: float
    half_y: float
    corner_cut: float
    walls: bool
    height: float
    """Height of walls and goals."""
    thickness: float
    goal_x: float
    goal_half: float
    goal_depth: float
    carpet_x: float
    carpet_y: float
    line_half: float
    """Half the width of a line."""
    shadows: float
    """How dark the walls' shadow on the carpet is, 0..1."""


@kernel
def spread(coarse: Floats, step: int, fine: FloatImage) -> None:
    """Fill fine, shape (height, width, 2), by bilinear interpolation of values at every step-th row and column."""
    for v in range(fine.shape[0]):
        row, fv = v // step, (v % step) / step
        for u in range(fine.shape[1]):
            column, fu = u // step, (u % step) / step
            for axis in range(2):
                above = coarse[row, column, axis] * (1.0 - fu) + coarse[row, column + 1, axis] * fu
                below = coarse[row + 1, column, axis] * (1.0 - fu) + coarse[row + 1, column + 1, axis] * fu
                fine[v, u, axis] = above * (1.0 - fv) + below * fv


@kernel
def color_floor(
    image: FloatImage, floor: FloatImage, eye: Floats, venue: Venue,
    lines: Floats, arcs: Floats, clutter: Floats, colors: Floats,
) -> None:  # fmt: skip
    """Give every pixel the mean color of its rays.

    image: shape (height, width, 3), the result; floor: where the rays of pixels -1 .. width and -1 .. height meet
    the floor, shape (height + 2, width + 2, 2) [m]; eye: optical center, shape (3,); lines: x1, y1, x2, y2,
    shape (n, 4); arcs: x, y, radius, start, end, shape (m, 5); clutter: shape (k, 10); colors: of the materials.
    """
    shade = np.zeros(len(colors))
    color = np.zeros(3)
    nearby = np.empty_like(clutter)
    for v in range(image.shape[0]):
        for u in range(image.shape[1]):
            # the pixel's point on the floor, and how it moves with one pixel to the right (ux, uy) and down (vx, vy)
            x, y = floor[v + 1, u + 1]
            ux, uy = (floor[v + 1, u + 2] - floor[v + 1, u]) * 0.5
            vx, vy = (floor[v + 2, u + 1] - floor[v, u + 1]) * 0.5
            _shade_materials(shade, venue, x, y)
            size = FOOTPRINT_PX * (abs(ux) + abs(uy) + abs(vx) + abs(vy))
            # most pixels show carpet only: one ray is enough
            if _is_plain_carpet(venue, x, y, size, lines, arcs):
                for channel in range(3):
                    image[v, u, channel] = colors[CARPET, channel] * shade[CARPET]
                continue
            # all others get the mean of 4x4 rays
            image[v, u] = 0.0
            near = _gather_clutter(nearby, clutter, x, y, size)
            for sample in range(GRID * GRID):
                du = FOOTPRINT_PX * ((sample % GRID + 0.5) / GRID - 0.5)
                dv = FOOTPRINT_PX * ((sample // GRID + 0.5) / GRID - 0.5)
                x_ray, y_ray = x + du * ux + dv * vx, y + du * uy + dv * vy
                _color_ray(color, venue, eye, x_ray, y_ray, lines, arcs, nearby[:near], colors, shade)
                for channel in range(3):
                    image[v, u, channel] += color[channel] / (GRID * GRID)


@kernel
def _is_plain_carpet(venue: Venue, x: float, y: float, size: float, lines: Floats, arcs: Floats) -> bool:
    """Do all rays of a pixel meet the carpet, away from lines? size: how far they spread on the floor [m]."""
    ax, ay = abs(x) + size, abs(y) + size
    inside = ax < min(venue.goal_x, venue.half_x) and ay < venue.half_y
    inside = inside and ax + ay < venue.half_x + venue.half_y - venue.corner_cut
    return inside and not _on_line(venue.line_half + size, x, y, lines, arcs)


@kernel
def _gather_clutter(nearby: Floats, clutter: Floats, x: float, y: float, size: float) -> int:
    """Copy the clutter that may cover a part of a pixel into nearby; return how many items there are."""
    count = 0
    for i in range(len(clutter)):
        reach = clutter[i, 5] + clutter[i, 6] + size
        if (x - clutter[i, 1]) ** 2 + (y - clutter[i, 2]) ** 2 < reach * reach:
            for column in range(clutter.shape[1]):
                nearby[count, column] = clutter[i, column]
            count += 1
    return count


@kernel
def _color_ray(
    color: Floats, venue: Venue, eye: Floats, x: float, y: float,
    lines: Floats, arcs: Floats, clutter: Floats, colors: Floats, shade: Floats,
) -> None:  # fmt: skip
    """The color of the ray that would meet the floor at x, y."""
    material = _material(venue, eye, x, y, lines, arcs)
    for channel in range(3):
        color[channel] = colors[material, channel] * shade[material]
    if material == WOOD:
        color_clutter(color, x, y, clutter)


@kernel
def color_clutter(color: Floats, x: float, y: float, clutter: Floats) -> None:
    """Replace the color of a point of the wooden floor by that of the clutter on it; later items cover earlier ones."""
    for i in range(len(clutter)):
        dx, dy = x - clutter[i, 1], y - clutter[i, 2]
        along = clutter[i, 3] * dx + clutter[i, 4] * dy
        across = clutter[i, 3] * dy - clutter[i, 4] * dx
        if clutter[i, 0] == DISC:
            inside = dx * dx + dy * dy <= clutter[i, 5] ** 2
        else:
            inside = abs(along) <= clutter[i, 5] and abs(across) <= clutter[i, 6]
        if inside:
            for channel in range(3):
                color[channel] = clutter[i, 7 + channel]


@kernel
def _material(venue: Venue, eye: Floats, x: float, y: float, lines: Floats, arcs: Floats) -> int:
    """The material that the ray towards a point of the floor meets first."""
    if not (math.isfinite(x) and math.isfinite(y)):
        return HORIZON
    ax, ay = abs(x), abs(y)
    # walls and goals: test the ray from their top down to the floor, unless it passes outside of all of them
    if ax >= min(venue.goal_x, venue.half_x) or ay >= venue.half_y or venue.corner_cut > 0.0:
        rise = venue.height / eye[2]
        beyond_x, beyond_y = venue.goal_x + venue.goal_depth + venue.thickness, venue.half_y + venue.thickness
        clear = min(ax, abs(x + (eye[0] - x) * rise)) >= beyond_x or min(ay, abs(y + (eye[1] - y) * rise)) >= beyond_y
        for depth in range(0 if clear else HEIGHT_STEPS + 1):
            height_ratio = venue.height * (1.0 - depth / HEIGHT_STEPS) / eye[2]
            solid = solid_at(venue, x + (eye[0] - x) * height_ratio, y + (eye[1] - y) * height_ratio)
            if solid == WALL:
                return BOARD_TOP if depth == 0 else BOARD_FACE
            if solid != NOTHING:
                return BOARD_TOP if depth == 0 else (NET_LEFT if solid == GOAL_LEFT else NET_RIGHT)
    return floor_material(venue, x, y, lines, arcs)


@kernel
def floor_material(venue: Venue, x: float, y: float, lines: Floats, arcs: Floats) -> int:
    """The material of a point of the floor: CARPET, LINE or WOOD."""
    ax, ay = abs(x), abs(y)
    if ax > venue.carpet_x or ay > venue.carpet_y:
        in_goal = ax < venue.goal_x + venue.goal_depth and ay < venue.goal_half
        return CARPET if in_goal else WOOD
    return LINE if _on_line(venue.line_half, x, y, lines, arcs) else CARPET


@kernel
def solid_at(venue: Venue, x: float, y: float) -> int:
    """What stands at a point of the floor: NOTHING, WALL, GOAL_LEFT or GOAL_RIGHT."""
    ax, ay = abs(x), abs(y)
    deep, wide, thick = venue.goal_x + venue.goal_depth, venue.goal_half, venue.thickness
    has_goal = venue.goal_depth > 0.0 and wide > 0.0
    if has_goal and ay < wide and venue.goal_x <= ax < deep:
        return NOTHING
    if venue.walls:
        diagonal = venue.half_x + venue.half_y - venue.corner_cut
        if ax < venue.half_x and ay < venue.half_y and ax + ay < diagonal:
            return NOTHING
        if ax < venue.half_x + thick and ay < venue.half_y + thick and ax + ay < diagonal + 1.4142 * thick:
            return WALL
    if has_goal and ay < wide + thick and venue.goal_x <= ax < deep + thick:
        return GOAL_LEFT if x < 0.0 else GOAL_RIGHT
    return NOTHING


@kernel
def _on_line(half: float, x: float, y: float, lines: Floats, arcs: Floats) -> bool:
    """Is a point within half a line's width of a line or arc?"""
    margin = 1.5 * half  # of the box round a line in any direction; most points lie outside of most boxes
    for i in range(len(lines)):
        if x < min(lines[i, 0], lines[i, 2]) - margin or x > max(lines[i, 0], lines[i, 2]) + margin:
            continue
        if y < min(lines[i, 1], lines[i, 3]) - margin or y > max(lines[i, 1], lines[i, 3]) + margin:
            continue
        dx, dy = lines[i, 2] - lines[i, 0], lines[i, 3] - lines[i, 1]
        length = math.hypot(dx, dy)
        px, py = x - lines[i, 0], y - lines[i, 1]
        along, across = (px * dx + py * dy) / length, (py * dx - px * dy) / length
        if -half <= along <= length + half and abs(across) <= half:
            return True
    for i in range(len(arcs)):
        dx, dy = x - arcs[i, 0], y - arcs[i, 1]
        if abs(math.hypot(dx, dy) - arcs[i, 2]) <= half:
            turned = (math.atan2(dy, dx) - arcs[i, 3]) % (2.0 * math.pi)
            if turned <= arcs[i, 4] - arcs[i, 3]:
                return True
    return False


@kernel
def _shade_materials(shade: Floats, venue: Venue, x: float, y: float) -> None:
    """Fill shade with a factor per material at a point, ``shade_of``."""
    for material in range(len(shade)):
        shade[material] = shade_of(material, venue, x, y)


@kernel
def shade_of(material: int, venue: Venue, x: float, y: float) -> float:
    """Factor of a material's color at a point: texture of carpet and wood, shadows of the walls."""
    if material == WOOD:
        plank = math.floor(y / 0.09)
        board = math.floor((x + 0.37 * (plank % 7)) / 0.6)
        return 1.0 + (0.10 * _grain(board, plank, 5) + 0.03 * mottle(x * 0.1, y, 0.006, 6))
    if material == BOARD_TOP:
        return 1.0 + 0.02 * mottle(x, y, 0.05, 7)
    if material == CARPET:
        shade = 1.0 + (0.05 * mottle(x, y, 0.007, 1) + 0.05 * mottle(x, y, 0.03, 2) + 0.05 * mottle(x, y, 0.4, 3))
    elif material == LINE:
        shade = 1.0 + 0.05 * mottle(x, y, 0.02, 4)
    else:
        return 1.0
    if venue.walls:
        near = max(min(venue.half_x - abs(x), venue.half_y - abs(y)), 0.0)
        shade *= 1.0 - 0.6 * venue.shadows * math.exp(-near / 0.04)
    return shade


@kernel
def mottle(x: float, y: float, size: float, seed: int) -> float:
    """Value noise in -1..1: random values on a lattice with a spacing of size [m], interpolated smoothly."""
    gx, gy = x / size, y / size
    ix, iy = math.floor(gx), math.floor(gy)
    fx, fy = gx - ix, gy - iy
    fx, fy = fx * fx * (3.0 - 2.0 * fx), fy * fy * (3.0 - 2.0 * fy)
    low = _grain(ix, iy, seed) * (1.0 - fx) + _grain(ix + 1, iy, seed) * fx
    high = _grain(ix, iy + 1, seed) * (1.0 - fx) + _grain(ix + 1, iy + 1, seed) * fx
    return low * (1.0 - fy) + high * fy


@kernel
def _grain(ix: float, iy: float, seed: int) -> float:
    """The pseudo-random value in -1..1 of a point of the lattice, by a multiplicative hash."""
    mixed = (np.int64(ix) * 374761393 + np.int64(iy) * 668265263 + seed * 974634777) & 0xFFFFFFFF
    mixed = ((mixed ^ (mixed >> 13)) * 1274126177) & 0xFFFFFFFF
    return ((mixed ^ (mixed >> 16)) & 0xFFFF) / 32767.5 - 1.0
