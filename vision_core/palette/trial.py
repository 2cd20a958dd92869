"""The hot path as the judge of a palette: how well do these colors explain these pictures?

A picture counts what is read in it: for every robot its confidence, times how clearly the picture shows its marker at
its place (``marker_shape.score_of``, which knows no colors), so that a reading of carpet and shadows is worth
nothing. Colored areas on the field that belong to no robot and no ball count against the palette.
"""

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import msgspec
import numpy as np

from vision_core.clock import Instant, ManualClock
from vision_core.color.light import Relighter, field_samples
from vision_core.color.samples import hex_from_bgr
from vision_core.geometry import Bytes, Floats, PixelPlaces
from vision_core.models.camera_kernels import CameraMap, camera_map_from
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent
from vision_core.models.from_settings import robots_of
from vision_core.objects.field_limits import accepted_extents
from vision_core.objects.robots.marker_shape import SIZES, Scene, scene_of, score_of
from vision_core.objects.robots.shape_search import Candidate, find_candidates
from vision_core.objects.robots.template import NEUTRAL, Template, disc_template, template_of
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.patterns.pattern import TEAM, Pattern
from vision_core.patterns.worn import colors_of, patterns_by_team, worn_patterns
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.suggestions import Suggestions
from vision_core.settings.schema import LightSettings, Settings
from vision_core.types.colors import ColorTable, Light
from vision_core.types.image import ImageFrame
from vision_core.types.objects import Team
from vision_core.types.tables import TEAMS, SightingsTable, Table

BALL = -1
"""Index of the ball beside the teams."""
READ_GAIN, READ_COST = 2.0, 0.2
"""A robot that is read is worth its confidence times READ_GAIN * evidence - READ_COST."""
UNREAD_GAIN, UNREAD_COST = 0.15, 0.1
CLUTTER_COST, MAX_CLUTTER = 0.05, 60.0
"""Per area of a team's patch that is colored without a reason; areas beyond are counted as MAX_CLUTTER."""
MAX_FLOOR_PIXELS = 80_000
"""Pixels of a picture that are looked at to learn what the floor looks like."""
ROBOT_RADII, BALL_RADII = 1.5, 2.0
"""Colored areas so near to a robot or the ball belong to it."""


class Kind(NamedTuple):
    """A team's marker, or the ball."""

    name: str
    template: Template
    height_m: float
    ids: tuple[int, ...]
    worn: np.ndarray
    """Number of the paint of every patch of the template for every id, shape (ids, patches)."""

    @property
    def shape(self) -> tuple[bytes, float]:
        """What tells it from kinds that look different without their colors."""
        return self.template.points_m.tobytes(), self.height_m


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture in the light of the palette."""

    pixels: Bytes
    scene: Scene
    floor_bgr: Floats
    """Colors of a grid over the field, shape (n, 3)."""
    shapes: dict[tuple[bytes, float], list[Candidate]] = field(default_factory=dict)
    """What was found by shape, by template and height: ``Trial.shapes``."""


@dataclass(frozen=True, slots=True)
class Judged:
    """What a palette reads in a picture."""

    score: float
    robots: Table
    evidence: Floats
    """How clearly the picture shows each robot's marker, 0 for one that is not read; shape (robots,)."""
    balls: Table
    clutter: float
    """Colored areas without a reason, in areas of a team's patch."""


def paints_of(settings: Settings) -> tuple[str, ...]:
    """The color classes that the robots and the ball of some settings need, the ball's last.

    Raises SettingsError for a pattern that cannot be read.
    """
    worn = colors_of(patterns_by_team(settings.robots))
    return tuple(dict.fromkeys((*worn, settings.ball.color)))


class Trial:
    """Sees pictures of one camera with one palette after another."""

    def __init__(self, settings: Settings, light: LightSettings) -> None:
        self.paints = paints_of(settings)
        self.typical = np.array([PAINTS_BGR.get(name, (127, 127, 127)) for name in self.paints], dtype=np.float64)
        """Blue, green, red of every paint as its name says, shape (paints, 3)."""
        samples = {name: (hex_from_bgr(bgr.tolist()),) for name, bgr in zip(self.paints, self.typical, strict=True)}
        colors = msgspec.structs.replace(settings.colors, classes={}, samples=samples, light=light)
        self.settings = msgspec.structs.replace(settings, colors=colors)
        self.camera = CameraSetup.from_settings(self.settings)
        self.camera_map: CameraMap = camera_map_from(self.camera.model)
        self.half_extent_m = accepted_half_extent(settings.field)
        self._perception = Perception(self.settings, self.camera)
        self._relighter = Relighter(*self.camera.size_px)
        self._floor: PixelPlaces = field_samples(
            self.camera.model, settings.field, self.camera.size_px, -settings.field.margin_m
        )
        self.colorless = np.array([name in NEUTRAL for name in self.paints])
        """Which paints are white or grey."""
        self.kinds = tuple(self._kinds())
        self.floor_px, self.floor_m = self._floor_grid()
        """Pixels of the area in which robots are accepted, and their places, shapes (n, 2)."""
        half = np.array([settings.field.length_m, settings.field.width_m]) / 2.0
        self.is_field = np.asarray((np.abs(self.floor_m) < half).all(axis=1))
        """Which of them lie inside the field's lines or walls, shape (n,)."""
        self._patch_px = self._area_of_anchor()

    def prepared(self, pixels: Bytes, light: Light | None = None) -> Picture:
        """A picture in the light of the settings. pixels: shape (height, width, 3), of the camera's size.

        light: that of the picture; None: it is measured.
        """
        if light is None:
            lit = self._perception.lighting.lit(pixels, Instant(0)).copy()
        else:
            lit = self._relighter.relit(pixels, light).copy()
        floor = lit[self._floor[:, 1], self._floor[:, 0]].astype(np.float64)
        return Picture(lit, scene_of(lit, self._floor), floor)

    def shapes(self, picture: Picture, kind: Kind) -> list[Candidate]:
        """Everything in a picture that has the shape of a marker or the ball; searched once, which takes its time."""
        key = kind.shape
        if key not in picture.shapes:
            picture.shapes[key] = find_candidates(
                picture.pixels, picture.scene, self.camera_map, kind.template, kind.height_m, self.half_extent_m
            )
        return picture.shapes[key]

    @property
    def light(self) -> Light:
        """Of the last picture that was measured."""
        return self._perception.lighting.light

    def use(self, table: ColorTable) -> None:
        """See the next pictures with the colors of a table that has all paints in their order."""
        self._perception.recolor(table)

    def read(self, picture: Picture) -> Judged:
        """What the palette reads in a picture, with the robots that only their shape shows; takes its time."""
        perception, seen = self._perception, self._seen_in(picture)
        poses = perception.shape_search.beside(lambda look: self.shapes(picture, self.kinds[look]), perception.robots)
        perception.confirm(Suggestions(picture.scene.plain, poses))
        return self._judged(picture, seen)

    def judge(self, picture: Picture) -> Judged:
        """What the palette reads in a picture by its blobs."""
        return self._judged(picture, self._seen_in(picture))

    def _seen_in(self, picture: Picture) -> SightingsTable:
        frame = ImageFrame(self.camera.name, 1, Instant(0), picture.pixels)
        return self._perception.perceive_lit(frame, ManualClock())

    def _judged(self, picture: Picture, seen: SightingsTable) -> Judged:
        counts = seen.counts.tolist()
        robots, balls = seen.robots[: counts[0]].copy(), seen.balls[: counts[1]].copy()
        evidence, score = np.zeros(len(robots)), 0.0
        for number, robot in enumerate(robots):
            kind = self.kind_of(robot)
            shown = 0.0
            if not math.isnan(robot["heading_rad"]):
                pose = robot["x_m"], robot["y_m"], robot["heading_rad"]
                at = kind.height_m
                shown = max(score_of(picture.scene, self.camera_map, kind.template, at, *pose, size) for size in SIZES)
            is_read = robot["id"] >= 0 if len(kind.ids) > 1 else shown > 0.0
            if is_read:
                evidence[number] = shown
                score += robot["confidence"] * (READ_GAIN * shown - READ_COST)
            else:
                score += UNREAD_GAIN * shown - UNREAD_COST
        clutter = self._clutter(robots, balls[:1])
        return Judged(score - CLUTTER_COST * min(clutter, MAX_CLUTTER), robots, evidence, balls, clutter)

    def kind_of(self, robot: Any) -> Kind:
        """The marker of a robot, by its id; the first one of its team where it has none."""
        own = [kind for kind in self.kinds[:BALL] if kind.name == TEAMS[robot["team"]]]
        return next((kind for kind in own if robot["id"] in kind.ids), own[0])

    def _floor_grid(self) -> tuple[PixelPlaces, Floats]:
        width, height = self.camera.size_px
        step = max(1, round(math.sqrt(width * height / MAX_FLOOR_PIXELS)))
        y, x = np.mgrid[0:height:step, 0:width:step]
        pixels = np.column_stack([x.ravel(), y.ravel()]).astype(np.int32)
        places = self.camera.model.field_from_pixel(pixels.astype(np.float64))
        away = np.abs(places)
        x, y, goal_x, goal_y = accepted_extents(self.settings.field, self.settings.robots.margin_m)
        with np.errstate(invalid="ignore"):
            inside = (away <= (x, y)).all(axis=1) | (away <= (goal_x, goal_y)).all(axis=1)
        return pixels[inside], places[inside]

    def _kinds(self) -> list[Kind]:
        kinds = []
        for team in TEAMS:
            robots = robots_of(self.settings.robots, team)
            for pattern in worn_patterns(self.settings.robots, team):
                ids = tuple(pattern.code_by_id)
                worn = [[self.paints.index(color) for color in _worn(pattern, team, number)] for number in ids]
                kinds.append(Kind(team, template_of(pattern), robots.height_m, ids, np.array(worn)))
        radius = self.settings.ball.radius_m
        ball = np.array([[self.paints.index(self.settings.ball.color)]])
        return [*kinds, Kind("ball", disc_template(radius), radius, (0,), ball)]

    def _area_of_anchor(self) -> float:
        """Area of the smaller team's patch in the middle of the field [px]."""
        areas = [marker.anchor_area_m2 for marker in self._perception.context.robots.markers]
        return min(areas) * float(self.camera.model.pixels_per_square_metre(np.zeros((1, 2)))[0])

    def _clutter(self, robots: Table, balls: Table) -> float:
        blobs = self._perception.blobs[: self._perception.blob_count]
        places = self.camera.model.field_from_pixel(np.column_stack([blobs["x_px"], blobs["y_px"]]))
        with np.errstate(invalid="ignore"):
            left = (np.abs(places) < np.array(self.half_extent_m)).all(axis=1)
        for things, radius in ((robots, 0.0), (balls, BALL_RADII * self.settings.ball.radius_m)):
            for thing in things:
                own = radius or ROBOT_RADII * robots_of(self.settings.robots, TEAMS[thing["team"]]).radius_m
                left &= np.hypot(places[:, 0] - thing["x_m"], places[:, 1] - thing["y_m"]) > own
        return float(blobs["area_px"][left].sum()) / self._patch_px


def _worn(pattern: Pattern, team: Team, number: int) -> list[str]:
    """The paints of a robot's patches, the team's patch first."""
    colors = pattern.colors_worn(team, number)
    anchor = next(index for index, patch in enumerate(pattern.patches) if patch.color == TEAM)
    return [colors[anchor], *(color for index, color in enumerate(colors) if index != anchor)]
