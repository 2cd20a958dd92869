"""The image of the empty venue, where every ray meets the floor, and how much light each pixel gets."""

import math
from dataclasses import dataclass

import numpy as np

from vision_core.capture.synthetic.floor import (
    COLORS,
    DISC,
    NOTHING,
    RECTANGLE,
    THING_COLUMNS,
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

RAY_STEP = 4
"""Pixels between rays that are worked out in full."""
BOARD_M = 0.025
"""Thickness of walls and goals."""
GOAL_HEIGHT_M = 0.16
"""Of goals on a field without walls; with walls they are as high as these."""
CARPET_BEYOND_M = 0.1
"""A field without walls lies on a carpet that goes on so far beyond its limit."""
BESIDE_M = 0.5
"""Clutter lies up to so far beside the field."""
CLUTTER = 60
DECOYS_BGR = ((30, 110, 245), (190, 70, 235), (200, 95, 25), (45, 205, 230), (90, 215, 70))
DULL_BGR = ((45, 38, 36), (70, 66, 60), (150, 150, 148), (40, 52, 88), (96, 72, 52), (205, 205, 200))
LAMPS_M = 1.6
"""Distance over which the light of the lamps rises and falls."""


@dataclass(frozen=True, slots=True)
class Background:
    """What stands still before one camera."""

    pixels: Bytes
    """Shape (height, width, 3), without noise."""
    floor: FloatImage
    """Where the rays of pixels -1 .. width, -1 .. height meet the floor [m]; shape (height + 2, width + 2, 2)."""
    light: FloatImage
    """Factor for every color, shape (height, width)."""


_newest: list[tuple[object, Background]] = []
"""The background that was made last, and for what: a spare that becomes the source has it already."""


def make_background(settings: Settings, camera: CameraSetup) -> Background:
    """Render the empty venue, once in a process. The arrays are read-only."""
    wanted = camera, settings.field, settings.synthetic
    if not _newest or _newest[0][0] != wanted:
        _newest[:] = [(wanted, _painted(settings, camera))]
    return _newest[0][1]


def _painted(settings: Settings, camera: CameraSetup) -> Background:
    width, height = camera.size_px
    floor = _floor_points(camera.model, width, height)
    light = _light(settings.synthetic, floor[1:-1, 1:-1])
    venue = _venue(settings)
    lines, arcs = field_lines(settings.field)
    image = np.empty((height, width, 3), dtype=np.float32)
    color_floor(
        image,
        floor,
        np.array(camera.model.position_m),
        venue,
        np.array(lines).reshape(-1, 4),
        np.array([(arc.x_m, arc.y_m, arc.radius_m, arc.start_rad, arc.end_rad) for arc in arcs]).reshape(-1, 5),
        _clutter(settings, venue),
        COLORS,
    )
    pixels = (image * light[..., None] + 0.5).clip(0, 255).astype(np.uint8)
    return Background(frozen(pixels), frozen(floor), frozen(light))


def _floor_points(camera: CameraModel, width: int, height: int) -> FloatImage:
    """Where the rays of pixels -1 .. width, -1 .. height meet the floor.

    Removing the lens distortion is an iteration; done at every fourth pixel it is off by less than 0.01 mm
    between, and takes a sixteenth of the time.
    """
    v, u = np.mgrid[-1 : height + 1 + RAY_STEP : RAY_STEP, -1 : width + 1 + RAY_STEP : RAY_STEP]
    grid = np.column_stack([u.ravel(), v.ravel()]).astype(np.float64)
    floor = np.empty((height + 2, width + 2, 2), dtype=np.float32)
    spread(camera.field_from_pixel(grid).reshape(*u.shape, 2), RAY_STEP, floor)
    return floor


def _venue(settings: Settings) -> Venue:
    field = settings.field
    half_x, half_y = accepted_half_extent(field)
    beyond = 0.0 if field.walls else CARPET_BEYOND_M
    return Venue(
        half_x=half_x,
        half_y=half_y,
        corner_cut=field.corner_cut_m,
        walls=field.walls,
        height=field.wall_height_m if field.walls else GOAL_HEIGHT_M,
        thickness=BOARD_M,
        goal_x=goal_line_x(field),
        goal_half=field.goal.width_m / 2.0,
        goal_depth=field.goal.depth_m,
        carpet_x=half_x + beyond,
        carpet_y=half_y + beyond,
        line_half=field.line_width_m / 2.0,
        shadows=settings.synthetic.shadows,
    )


def _light(synthetic: SyntheticSettings, floor: FloatImage) -> FloatImage:
    """Brightness, vignetting (falls with the square of the distance from the middle) and lamps over the floor."""
    height, width, _ = floor.shape
    v, u = np.mgrid[0:height, 0:width]
    off = ((u - (width - 1) / 2.0) ** 2 + (v - (height - 1) / 2.0) ** 2) / ((width**2 + height**2) / 4.0)
    place = np.nan_to_num(floor)
    lamps = np.sin(place[..., 0] / LAMPS_M * math.pi + 0.8) * np.cos(place[..., 1] / LAMPS_M * math.pi - 0.6)
    lens = synthetic.brightness * (1.0 - synthetic.vignetting * off)
    return np.asarray(lens * (1.0 + 0.5 * synthetic.uneven_light * lamps), dtype=np.float32)


def _clutter(settings: Settings, venue: Venue) -> Floats:
    """Bags, cups, cables and things in the markers' colors on the floor beside the field; shape (k, 10)."""
    if not settings.synthetic.clutter:
        return np.empty((0, THING_COLUMNS))
    rng = np.random.default_rng([settings.synthetic.seed, 3])
    things: list[tuple[float, ...]] = []
    for number in range(CLUTTER):
        x, y = _place_beside(rng, settings.field, venue)
        angle = rng.uniform(0.0, math.pi)
        match number % 4:
            case 0:
                size = rng.uniform(0.05, 0.16), rng.uniform(0.04, 0.10)
                things.append(_thing(RECTANGLE, x, y, angle, *size, DULL_BGR[rng.integers(len(DULL_BGR))]))
            case 1:
                things.append(_thing(DISC, x, y, 0.0, 0.04, 0.04, (215, 218, 216)))
                things.append(_thing(DISC, x, y, 0.0, 0.033, 0.033, (40, 58, 82)))
            case 2:
                radius = rng.uniform(0.012, 0.03)
                things.append(_thing(DISC, x, y, 0.0, radius, radius, DECOYS_BGR[rng.integers(len(DECOYS_BGR))]))
            case _:
                things += _cable(rng, x, y, angle)
    return np.array(things)


def _place_beside(rng: np.random.Generator, field: FieldSettings, venue: Venue) -> tuple[float, float]:
    """A place outside the walls (or the limit) and the goals."""
    most = np.array(accepted_half_extent(field)) + BESIDE_M
    while True:
        x, y = rng.uniform(-most, most).tolist()
        outside = abs(x) > venue.carpet_x + 2.0 * BOARD_M or abs(y) > venue.carpet_y + 2.0 * BOARD_M
        if outside and solid_at(venue, x, y) == NOTHING:
            return x, y


def _cable(rng: np.random.Generator, x: float, y: float, angle: float) -> list[tuple[float, ...]]:
    pieces = []
    for _ in range(16):
        half_x, half_y = 0.02 * math.cos(angle), 0.02 * math.sin(angle)
        pieces.append(_thing(RECTANGLE, x + half_x, y + half_y, angle, 0.022, 0.004, (26, 24, 24)))
        x, y = x + 2.0 * half_x, y + 2.0 * half_y
        angle += rng.normal(0.0, 0.25)
    return pieces


def _thing(
    kind: int, x: float, y: float, angle: float, half_length: float, half_width: float, bgr: tuple[int, int, int]
) -> tuple[float, ...]:  # fmt: skip
    return (kind, x, y, math.cos(angle), math.sin(angle), half_length, half_width, *bgr)
