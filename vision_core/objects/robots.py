"""Robots by their markers."""

import math
from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from vision_core.camera_model import CameraModel
from vision_core.geometry import Floats, wrap_angle
from vision_core.objects.hypotheses import CENTER, FIRST_DOT, HEADING, MATCHED, SCORE, X, Y, propose
from vision_core.objects.likeness import likeness
from vision_core.objects.patterns import Marker
from vision_core.settings import RobotSettings
from vision_core.types.blobs import Blobs
from vision_core.types.colors import ColorTable
from vision_core.types.objects import RobotSighting, Team

TEAMS = (Team.BLUE, Team.YELLOW)

NEAREST = 0.8
"""Centers nearer than this share of a robot's diameter cannot both be robots."""

RIVAL_SCORE = 0.8
RIVAL_TURN_RAD = math.radians(10.0)
"""A hypothesis for the same center with as many dots, this share of the score and this much turned
makes the heading ambiguous."""

MOST_ROBOTS = 64
"""Twice two full teams: what a cloth of dots shows beyond these is no robot, and must find room in the database."""

ENOUGH_DOTS = 3
"""Fewer dots tell no heading: the pattern's angles repeat."""

NUMERALS = {2: "two", 3: "three", 4: "four"}

Indices = NDArray[np.intp]
Row = list[float]
"""A hypothesis, see ``hypotheses``."""


@dataclass(frozen=True, slots=True)
class Dots:
    """Blobs that may be dots of a marker, as arrays of equal length."""

    blob: Indices
    """Their numbers in the frame's Blobs."""
    color: tuple[str, ...]
    place_m: Floats
    """Shape (n, 2), at marker height."""
    share: Floats
    """Area over the one that a dot of its role must have."""


def find_robots(
    blobs: Blobs, table: ColorTable, camera: CameraModel, marker: Marker, settings: RobotSettings
) -> tuple[tuple[RobotSighting, ...], tuple[str, ...]]:
    """The robots that blobs show, by team and id, and why there are none or what contradicts itself.

    At most MOST_ROBOTS, the surest ones.
    Positions are the fitted marker's center in the field; (x_px, y_px) is its image at marker height.
    """
    measured = _measured(blobs, table, {*TEAMS, *marker.dot_colors}, camera, settings.height_m)
    every_center = _of_colors(measured, TEAMS, marker.center_area_m2)
    every_dot = _of_colors(measured, marker.dot_colors, marker.dot_area_m2)
    centers, dots = _of_right_size(every_center, settings), _of_right_size(every_dot, settings)
    array = propose(
        centers.place_m, likeness(centers.share), dots.place_m, likeness(dots.share),
        marker.slots_m, settings.dot_tolerance_m,
    )  # fmt: skip
    rows = array[np.argsort(-array[:, SCORE], kind="stable")].tolist()
    winners = _compete(rows, settings)
    if not winners:
        return (), (_why_none(blobs, every_center, centers, rows, settings),)
    places = np.array([(rows[number][X], rows[number][Y]) for number in winners])
    pixels = camera.pixel_from_field(places, settings.height_m).tolist()
    robots = [
        _sighting(rows[number], centers, dots, marker, pixel, ambiguous=ambiguous)
        for (number, ambiguous), pixel in zip(winners.items(), pixels, strict=True)
    ]
    return _unmistakable(robots)


def _measured(blobs: Blobs, table: ColorTable, colors: Collection[str], camera: CameraModel, height_m: float) -> Dots:
    """Blobs of some classes at marker height; shares are of a square metre."""
    wanted = np.array([name in colors for name in table.names])
    chosen = np.flatnonzero(wanted[blobs.color])
    place = camera.field_from_pixel(blobs.center_px[chosen], height_m)
    area_m2 = blobs.area_px[chosen] / camera.pixels_per_square_metre(place, height_m)
    return Dots(chosen, tuple(table.names[color] for color in blobs.color[chosen]), place, area_m2)


def _of_colors(dots: Dots, colors: Collection[str], area_m2: float) -> Dots:
    """Those of some colors, their areas as shares of an area."""
    chosen = _chosen(dots, np.array([color in colors for color in dots.color], dtype=np.bool_))
    return replace(chosen, share=chosen.share / area_m2)


def _of_right_size(dots: Dots, settings: RobotSettings) -> Dots:
    return _chosen(dots, (dots.share >= settings.min_area) & (dots.share <= settings.max_area))


def _chosen(dots: Dots, mask: NDArray[np.bool_]) -> Dots:
    return Dots(dots.blob[mask], tuple(compress(dots.color, mask)), dots.place_m[mask], dots.share[mask])


def _compete(rows: list[Row], settings: RobotSettings) -> dict[int, bool]:
    """The rows that win, best first, and whether the heading of each is ambiguous.

    rows: hypotheses, best first. A blob serves once, and robots do not stand in one another.
    """
    ambiguous: dict[int, bool] = {}
    winner_of_center: dict[float, int] = {}
    used: set[float] = set()
    spacing = NEAREST * 2.0 * settings.radius_m
    for number, row in enumerate(rows):
        if row[SCORE] < settings.min_confidence:
            break
        if (winner := winner_of_center.get(row[CENTER])) is not None:
            ambiguous[winner] |= _is_rival(row, rows[winner])
            continue
        dots = {dot for dot in row[FIRST_DOT:] if dot >= 0}
        near = (math.hypot(row[X] - rows[other][X], row[Y] - rows[other][Y]) for other in ambiguous)
        if len(ambiguous) < MOST_ROBOTS and not dots & used and all(distance >= spacing for distance in near):
            winner_of_center[row[CENTER]] = number
            ambiguous[number] = False
            used |= dots
    return ambiguous


def _is_rival(row: Row, winner: Row) -> bool:
    if row[MATCHED] != winner[MATCHED] or row[SCORE] < RIVAL_SCORE * winner[SCORE]:
        return False
    return abs(wrap_angle(row[HEADING] - winner[HEADING])) > RIVAL_TURN_RAD


def _sighting(
    row: Row, centers: Dots, dots: Dots, marker: Marker, pixel: list[float], *, ambiguous: bool
) -> RobotSighting:
    """A robot from a winning hypothesis."""
    told = not ambiguous and row[MATCHED] >= ENOUGH_DOTS
    code = "".join(dots.color[int(dot)][0].upper() if dot >= 0 else "-" for dot in row[FIRST_DOT:])
    return RobotSighting(
        team=Team(centers.color[int(row[CENTER])]),
        id=marker.id_by_code.get(code) if told else None,
        x_px=pixel[0],
        y_px=pixel[1],
        x_m=row[X],
        y_m=row[Y],
        heading_rad=wrap_angle(row[HEADING]) if told else None,
        confidence=row[SCORE],
        position_sd_m=0.001,
        heading_sd_rad=0.01 if told else None,
    )


def _unmistakable(robots: list[RobotSighting]) -> tuple[tuple[RobotSighting, ...], tuple[str, ...]]:
    """Robots by team and id. Which of two with the same id is which cannot be told: both lose it."""
    worn = Counter((robot.team, robot.id) for robot in robots if robot.id is not None)
    twice = {key: count for key, count in worn.items() if count > 1}
    kept = [replace(robot, id=None) if (robot.team, robot.id) in twice else robot for robot in robots]
    kept.sort(key=lambda robot: (robot.team, math.inf if robot.id is None else robot.id, robot.x_m))
    reasons = [f"{NUMERALS.get(count, count)} robots wear {team} {number}" for (team, number), count in twice.items()]
    return tuple(kept), tuple(reasons)


def _why_none(blobs: Blobs, every: Dots, centers: Dots, rows: list[Row], settings: RobotSettings) -> str:
    """Why no robot was seen: what came nearest to one, and what it lacks."""
    if not len(every.blob):
        return "no robot: no blob of a team's color"
    if not len(centers.blob):
        nearest = int(np.argmax(likeness(every.share)))
        return (
            f"no robot: {len(every.blob)} blobs of a team's color, none of a center dot's size; the nearest, at "
            f"{_place(blobs, every.blob[nearest])}, has {every.share[nearest]:.0%} of it "
            f"({settings.min_area:.0%} to {settings.max_area:.0%} are accepted)"
        )
    if not rows:
        nearest = int(np.argmax(likeness(centers.share)))
        return f"no robot: no dot round the team-colored blob at {_place(blobs, centers.blob[nearest])}"
    best = rows[0]
    return (
        f"no robot: the best, at {_place(blobs, centers.blob[int(best[CENTER])])} with {best[MATCHED]:.0f} dots, has "
        f"confidence {best[SCORE]:.2f}, below robots.min_confidence {settings.min_confidence:g}"
    )


def _place(blobs: Blobs, blob: int) -> str:
    x, y = blobs.center_px[blob]
    return f"({x:.0f}, {y:.0f}) px"
