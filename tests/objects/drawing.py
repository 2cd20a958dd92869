"""Small pictures of markers and balls, drawn through a camera model, for the tests of this folder."""

import math
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from bench.segmenters import ReferenceSegmenter
from vision_core.color.lookup_table import cell_centers, compile_color_table
from vision_core.color.references import references_of
from vision_core.geometry import Bytes, Floats, Mask, frozen, rotation
from vision_core.models.camera import CameraModel, PinholeCamera
from vision_core.models.field import painted_points
from vision_core.native.kernels import read_only
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import CODE, TEAM, Pattern
from vision_core.settings.schema import FieldSettings, Settings
from vision_core.types.colors import ColorTable
from vision_core.types.objects import Team
from vision_core.types.tables import Table
from vision_core.venues.loader import load_settings

Color = tuple[int, int, int]

PAINTS: dict[str, Color] = {
    "carpet": (50, 95, 45),
    "body": (40, 40, 40),
    "blue": (210, 100, 30),
    "yellow": (40, 200, 230),
    "pink": (190, 90, 235),
    "green": (90, 220, 80),
    "orange": (30, 110, 240),
    "red": (40, 40, 215),
    "cyan": (225, 210, 40),
    "purple": (120, 30, 80),
    "magenta": (200, 40, 235),
    "pale": (190, 200, 195),
    "white": (225, 230, 228),
}

SETTINGS: Settings = load_settings()
TABLE = compile_color_table(SETTINGS.colors)
STANDARD = load_pattern(SETTINGS.robots.patterns[0])
CODES = STANDARD.code_by_id

SUBPIXELS = 4

NEAR = 60.0
"""Colors nearer to a paint than this [grey levels] are of its class."""


def paint_table() -> ColorTable:
    """A table with a class for every paint of a marker."""
    names = [name for name in PAINTS if name not in {"carpet", "body", "white"}]
    paints = np.array([PAINTS[name] for name in names], dtype=np.float64)
    apart = np.linalg.norm(cell_centers()[:, None] - paints, axis=2)
    classes = np.where(apart.min(axis=1) <= NEAR, apart.argmin(axis=1) + 1, 0).astype(np.uint8)
    means = np.vstack([np.zeros((1, 3)), paints]).astype(np.uint8)
    references = references_of(classes, cell_centers(), 1 + len(names))
    return ColorTable(("", *names), frozen(classes), frozen(means), (), references)


PAINT_TABLE = paint_table()


def overhead_camera(metres_per_pixel: float, width: int, height: int) -> CameraModel:
    """A camera 3.5 m up, slightly tilted and turned, its picture's center near the field's."""
    return PinholeCamera(
        3.5 / metres_per_pixel, (width / 2, height / 2), (0, 0, 0, 0, 0), (0.1, 0.05, 3.5), (2, -1, 20)
    )


@dataclass
class Picture:
    """A picture of a piece of carpet, into which things are painted in any order that hides rightly."""

    camera: CameraModel
    width: int
    height: int
    pixels: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.pixels = np.full((self.height, self.width, 3), PAINTS["carpet"], dtype=np.float64)

    def paint_disc(self, paint: str, x_m: float, y_m: float, radius_m: float, height_m: float) -> None:
        """A disc in the plane of a height, its rim blended by what it covers of a pixel."""
        turns = np.linspace(0.0, math.tau, 24)
        rim = np.array([x_m, y_m]) + radius_m * np.column_stack([np.cos(turns), np.sin(turns)])
        if (window := self._window(rim, height_m)) is not None:
            places = self._places(window, height_m)
            self._paint(window, paint, np.hypot(places[:, 0] - x_m, places[:, 1] - y_m) <= radius_m)

    def paint_polygon(self, paint: str, corners_m: Floats, height_m: float) -> None:
        """A polygon, shape (n, 2), in the plane of a height."""
        if (window := self._window(corners_m, height_m)) is None:
            return
        places = self._places(window, height_m)
        covered = np.zeros(len(places), dtype=np.bool_)
        for (x1, y1), (x2, y2) in zip(corners_m, np.roll(corners_m, -1, axis=0), strict=True):
            if y1 != y2:
                beyond = places[:, 0] < x1 + (places[:, 1] - y1) * (x2 - x1) / (y2 - y1)
                covered ^= ((y1 > places[:, 1]) != (y2 > places[:, 1])) & beyond
        self._paint(window, paint, covered)

    def _window(self, outline_m: Floats, height_m: float) -> tuple[int, int, int, int] | None:
        """The part of the picture in which a thing with this outline lies: left, top, right, bottom; None: outside."""
        outline = self.camera.pixel_from_field(outline_m, height_m)
        low, high = np.floor(outline.min(axis=0)) - 2, np.ceil(outline.max(axis=0)) + 3
        left, top = np.maximum(low, 0).astype(int).tolist()
        right, bottom = np.minimum(high, (self.width, self.height)).astype(int).tolist()
        return (left, top, right, bottom) if left < right and top < bottom else None

    def _places(self, window: tuple[int, int, int, int], height_m: float) -> Floats:
        """Where the rays of a window's samples cross the plane of a height, shape (n, 2) [m]."""
        left, top, right, bottom = window
        steps = (np.arange(SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
        y, x, v, u = np.meshgrid(np.arange(top, bottom), np.arange(left, right), steps, steps, indexing="ij")
        return self.camera.field_from_pixel(np.column_stack([(x + u).ravel(), (y + v).ravel()]), height_m)

    def _paint(self, window: tuple[int, int, int, int], paint: str, covered: Mask) -> None:
        left, top, right, bottom = window
        part = self.pixels[top:bottom, left:right]
        share = covered.reshape(bottom - top, right - left, -1).mean(axis=2)[..., None]
        part += share * (np.array(PAINTS[paint]) - part)

    def paint_lines(self, field: FieldSettings) -> None:
        """The painted lines of a field, straight and round."""
        for points in painted_points(field, 41):
            for start, end in pairwise(points):
                aside = np.array([start[1] - end[1], end[0] - start[0]])
                aside *= field.line_width_m / 2.0 / np.hypot(*aside)
                along = (end - start) * 0.01
                corners = np.array(
                    [start - along + aside, end + along + aside, end + along - aside, start - along - aside]
                )
                self.paint_polygon("white", corners, 0.0)

    def paint_pattern(self, pattern: Pattern, team: str, code: str, pose: tuple[float, float, float]) -> None:
        """A robot's top with any pattern; "-" in the code leaves a patch away. pose: x, y [m], heading [rad]."""
        place, turn, robot = np.array(pose[:2]), rotation(pose[2]), pattern.robot
        square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) * robot.radius_m
        if robot.outline == "circle":
            self.paint_disc("body", *pose[:2], robot.radius_m, robot.height_m)
        else:
            self.paint_polygon("body", place + square @ turn.T, robot.height_m)
        letters, shapes = iter(code), [shape.name[0].upper() for shape in pattern.code.shapes]
        paint_of = {name[0].upper(): name for name in pattern.code.colors}
        for patch in pattern.patches:
            letter = next(letters) if patch.color == CODE else ""
            paint = pattern.team_color(Team(team)) if patch.color == TEAM else paint_of.get(letter, patch.color)
            if patch.shapes and letter != "-":
                letter = next(letters)
            if letter == "-":
                continue
            worn = patch.shapes[shapes.index(letter)] if patch.shapes else patch
            if worn.circle_mm is not None:
                x, y = place + turn @ (np.array(worn.circle_mm[:2]) / 1000.0)
                self.paint_disc(paint, float(x), float(y), worn.circle_mm[2] / 2000.0, robot.height_m)
            else:
                self.paint_polygon(paint, place + np.array(worn.polygon_mm) / 1000.0 @ turn.T, robot.height_m)

    def paint_robot(self, team: str, code: str, x_m: float, y_m: float, heading_rad: float) -> None:
        """A robot's top with the standard pattern."""
        self.paint_pattern(STANDARD, team, code, (x_m, y_m, heading_rad))

    def paint_ball(self, x_m: float, y_m: float) -> None:
        radius = SETTINGS.ball.radius_m
        self.paint_disc("orange", x_m, y_m, radius, radius)

    def as_bytes(self, noise: float = 2.0, seed: int = 1) -> Bytes:
        """What the camera delivers."""
        noisy = self.pixels + np.random.default_rng(seed).normal(0.0, noise, self.pixels.shape)
        return read_only(np.clip(np.rint(noisy), 0, 255).astype(np.uint8))

    def blobs(self, noise: float = 2.0, seed: int = 1, table: ColorTable = TABLE) -> Table:
        """BLOB table, shape (n,)."""
        segmenter = ReferenceSegmenter(self.width, self.height, SETTINGS.blobs)
        count, _ = segmenter.segment(self.as_bytes(noise, seed), table)
        return segmenter.blobs[:count]


def turn_between(one_rad: float | None, other_rad: float) -> float:
    """How far apart two headings are [rad]."""
    assert one_rad is not None
    return abs(math.remainder(one_rad - other_rad, math.tau))
