"""Renders the static background: the image of the empty venue, each pixel's point on the floor, each pixel's light."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from vision_core.capture.synthetic.floor import (
    CLUTTER_COLUMNS,
    COLORS,
    DISC,
    NOTHING,
    RECTANGLE,
    FloatImage,
    Venue,
    color_floor,
    solid_at,
    spread,
)
from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.camera import CameraModel
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent, field_lines, goal_line_x
from vision_core.settings.schema import FieldSettings, Settings, SyntheticSettings

RAY_STEP_PX = 4
"""Lens distortion is removed at every fourth pixel; the points on the floor between are interpolated."""
BOARD_THICKNESS_M = 0.025
"""Thickness of walls and goals."""
GOAL_HEIGHT_M = 0.16
"""Height of the goals on a field without walls. On a field with walls, goals are as high as the walls."""
CARPET_MARGIN_M = 0.1
"""The carpet of a field without walls extends so far beyond the field's limit."""
CLUTTER_MARGIN_M = 0.5
"""Clutter lies at most so far outside the field."""
CLUTTER_COUNT = 60
"""Items of clutter."""
DECOY_COLORS_BGR = ((30, 110, 245), (190, 70, 235), (200, 95, 25), (45, 205, 230), (90, 215, 70))
"""Colors of clutter that resemble the ball and the patches of markers."""
DULL_COLORS_BGR = ((45, 38, 36), (70, 66, 60), (150, 150, 148), (40, 52, 88), (96, 72, 52), (205, 205, 200))
"""Colors of bags and boxes."""
LAMP_HALF_PERIOD_M = 1.6
"""Half a period of the pattern of light that the lamps make on the floor."""


@dataclass(frozen=True, slots=True)
class Background:
    """What one camera sees of the empty venue."""

    pixels: Bytes
    """Shape (height, width, 3), without noise."""
    floor: FloatImage
    """Where the rays of pixels -1 .. width, -1 .. height meet the floor [m]; shape (height + 2, width + 2, 2)."""
    light: FloatImage
    """Factor for every color, shape (height, width)."""


_cached: list[tuple[object, Background]] = []
"""The background that was made last, with its camera and settings: a spare renders it before it becomes the source."""


def make_background(settings: Settings, camera: CameraSetup) -> Background:
    """Render the empty venue, or return the last background when nothing has changed. Arrays are read-only."""
    key = camera, settings.field, settings.synthetic
    if not _cached or _cached[0][0] != key:
        _cached[:] = [(key, _render_background(settings, camera))]
    return _cached[0][1]


def _render_background(settings: Settings, camera: CameraSetup) -> Background:
    width, height = camera.size_px
    floor = _floor_points(camera.model, width, height)
    light = _light(settings.synthetic, floor[1:-1, 1:-1])
    venue = venue_of(settings)
    lines, arcs = painted_lines(settings.field)
    image = np.empty((height, width, 3), dtype=np.float32)
    color_floor(
        image,
        floor,
        np.array(camera.model.position_m),
        venue,
        lines,
        arcs,
        clutter_of(settings, venue),
        COLORS,
    )
    pixels = (image * light[..., None] + 0.5).clip(0, 255).astype(np.uint8)
    return Background(frozen(pixels), frozen(floor), frozen(light))


def _floor_points(camera: CameraModel, width: int, height: int) -> FloatImage:
    """Where the rays of pixels -1 .. width, -1 .. height meet the floor.

    Removing the lens distortion is iterative and slow. It is done at every fourth row and column, which takes a
    sixteenth of the time; the error of the interpolated points is less than 0.01 mm.
    """
    v, u = np.mgrid[-1 : height + 1 + RAY_STEP_PX : RAY_STEP_PX, -1 : width + 1 + RAY_STEP_PX : RAY_STEP_PX]
    grid = np.column_stack([u.ravel(), v.ravel()]).astype(np.float64)
    floor = np.empty((height + 2, width + 2, 2), dtype=np.float32)
    spread(camera.field_from_pixel(grid).reshape(*u.shape, 2), RAY_STEP_PX, floor)
    return floor


def painted_lines(field: FieldSettings) -> tuple[Floats, Floats]:
    """The field's lines x1, y1, x2, y2, shape (n, 4), and arcs x, y, radius, start, end, shape (m, 5)."""
    lines, arcs = field_lines(field)
    rows = [(arc.x_m, arc.y_m, arc.radius_m, arc.start_rad, arc.end_rad) for arc in arcs]
    return np.array(lines).reshape(-1, 4), np.array(rows).reshape(-1, 5)


def venue_of(settings: Settings) -> Venue:
    """Dimensions of field, walls and goals, for the kernels."""
    field = settings.field
    half_x, half_y = accepted_half_extent(field)
    margin = 0.0 if field.walls else CARPET_MARGIN_M
    return Venue(
        half_x=half_x,
        half_y=half_y,
        corner_cut=field.corner_cut_m,
        walls=field.walls,
        height=field.wall_height_m if field.walls else GOAL_HEIGHT_M,
        thickness=BOARD_THICKNESS_M,
        goal_x=goal_line_x(field),
        goal_half=field.goal.width_m / 2.0,
        goal_depth=field.goal.depth_m,
        carpet_x=half_x + margin,
        carpet_y=half_y + margin,
        line_half=field.line_width_m / 2.0,
        shadows=settings.synthetic.shadows,
    )


def _light(synthetic: SyntheticSettings, floor: FloatImage) -> FloatImage:
    """Factor of each pixel's light: brightness, vignetting (by the squared distance from the center) and lamps."""
    height, width, _ = floor.shape
    v, u = np.mgrid[0:height, 0:width]
    radius2 = ((u - (width - 1) / 2.0) ** 2 + (v - (height - 1) / 2.0) ** 2) / ((width**2 + height**2) / 4.0)
    point = np.nan_to_num(floor)
    lamps = lamp_light(point[..., 0], point[..., 1])
    lens = synthetic.brightness * (1.0 - synthetic.vignetting * radius2)
    return np.asarray(lens * (1.0 + 0.5 * synthetic.uneven_light * lamps), dtype=np.float32)


def lamp_light(x: Any, y: Any) -> Any:
    """How much brighter, -1..1, the lamps make a point x, y of the floor [m]; numbers or arrays."""
    return np.sin(x / LAMP_HALF_PERIOD_M * math.pi + 0.8) * np.cos(y / LAMP_HALF_PERIOD_M * math.pi - 0.6)


def clutter_of(settings: Settings, venue: Venue) -> Floats:
    """Bags, cups, cables and dots in the markers' colors on the floor beside the field; shape (k, 10)."""
    if not settings.synthetic.clutter:
        return np.empty((0, CLUTTER_COLUMNS))
    rng = np.random.default_rng([settings.synthetic.seed, 3])
    rows: list[tuple[float, ...]] = []
    for number in range(CLUTTER_COUNT):
        x, y = _point_beside_field(rng, settings.field, venue)
        angle = rng.uniform(0.0, math.pi)
        match number % 4:
            case 0:  # a bag
                size = rng.uniform(0.05, 0.16), rng.uniform(0.04, 0.10)
                rows.append(
                    _clutter_row(RECTANGLE, x, y, angle, *size, DULL_COLORS_BGR[rng.integers(len(DULL_COLORS_BGR))])
                )
            case 1:  # a cup, full
                rows.append(_clutter_row(DISC, x, y, 0.0, 0.04, 0.04, (215, 218, 216)))
                rows.append(_clutter_row(DISC, x, y, 0.0, 0.033, 0.033, (40, 58, 82)))
            case 2:  # a decoy in a marker's color
                radius = rng.uniform(0.012, 0.03)
                rows.append(
                    _clutter_row(DISC, x, y, 0.0, radius, radius, DECOY_COLORS_BGR[rng.integers(len(DECOY_COLORS_BGR))])
                )
            case _:
                rows += _cable(rng, x, y, angle)
    return np.array(rows)


def _point_beside_field(rng: np.random.Generator, field: FieldSettings, venue: Venue) -> tuple[float, float]:
    """A random point on the floor outside the carpet, the walls and the goals."""
    limit = np.array(accepted_half_extent(field)) + CLUTTER_MARGIN_M
    while True:
        x, y = rng.uniform(-limit, limit).tolist()
        outside = abs(x) > venue.carpet_x + 2.0 * BOARD_THICKNESS_M or abs(y) > venue.carpet_y + 2.0 * BOARD_THICKNESS_M
        if outside and solid_at(venue, x, y) == NOTHING:
            return x, y


def _cable(rng: np.random.Generator, x: float, y: float, angle: float) -> list[tuple[float, ...]]:
    """A cable: 16 short straight pieces that bend at random."""
    pieces = []
    for _ in range(16):
        half_x, half_y = 0.02 * math.cos(angle), 0.02 * math.sin(angle)
        pieces.append(_clutter_row(RECTANGLE, x + half_x, y + half_y, angle, 0.022, 0.004, (26, 24, 24)))
        x, y = x + 2.0 * half_x, y + 2.0 * half_y
        angle += rng.normal(0.0, 0.25)
    return pieces


def _clutter_row(
    kind: int, x: float, y: float, angle: float, half_length: float, half_width: float, bgr: tuple[int, int, int]
) -> tuple[float, ...]:  # fmt: skip
    return (kind, x, y, math.cos(angle), math.sin(angle), half_length, half_width, *bgr)
