"""Truth files: which robots and balls each picture shows, and where [px], as a person reads it off.

Two forms, per picture (documented in ``docs/patterns.md``)::

    {"robots": [{"team": "blue", "id": 3, "center_px": [833, 353]}], "balls": [[510, 300]], "ignore": [[0, 0, 90, 40]]}
    {"blue": [701, 290], "yellow": [101, 137], "ball": null}

A kind of object that is left out is not scored. A kind that is listed as null or empty is absent from the picture, so
finding it is wrong.
"""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vision_core.errors import SourceError
from vision_core.settings.schema import Point2, Record
from vision_core.types.objects import Team
from vision_core.user_files import read_text

MAX_FILE_BYTES = 16 * 1024 * 1024

Box = tuple[float, float, float, float]
"""Left, top, right, bottom [px]."""


@dataclass(frozen=True, slots=True)
class TrueRobot:
    """A robot; id None where the truth does not give it."""

    team: Team
    id: int | None
    x_px: float
    y_px: float


@dataclass(frozen=True, slots=True)
class PictureTruth:
    """What one picture shows."""

    file: Path
    robots: tuple[TrueRobot, ...]
    teams_scored: frozenset[Team]
    balls: tuple[Point2, ...] | None
    """None: balls are not scored."""
    ignore: tuple[Box, ...]
    """Areas in which nothing that is found counts as false."""
    size_px: tuple[int, int] | None
    """Width and height of the picture, where the truth gives them."""
    asked: str
    """File and picture, as messages call them."""


class _Robot(Record, frozen=True):
    team: str
    id: Annotated[int, Meta(ge=0, le=255)] | None = None
    center_px: Point2 | None = None
    centre_px: Point2 | None = None


class _Listed(Record, frozen=True):
    robots: tuple[_Robot, ...] | None = None
    balls: tuple[Point2, ...] | None = None
    ignore: tuple[Box, ...] = ()
    image_size_px: tuple[int, int] | None = None
    note: str = ""


class _Single(Record, frozen=True):
    ball: Point2 | None = None
    blue: Point2 | None = None
    yellow: Point2 | None = None


def load_truth(path: Path) -> list[PictureTruth]:
    """The truth of every picture of a file, in its order; names of pictures are relative to the file.

    Raises SourceError naming file, picture and place: no JSON, unknown keys or teams, numbers that are not finite, the
    same robot twice.
    """
    asked = f"truth file {path}"
    text = read_text(path, asked, SourceError, max_bytes=MAX_FILE_BYTES)
    try:
        pictures = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise SourceError(asked, found=str(error), accepted="JSON") from None
    if not isinstance(pictures, dict) or not pictures:
        raise SourceError(asked, found="no pictures", accepted='{"PICTURE": {...}, ...}')
    return [_picture(path, name, table) for name, table in pictures.items()]


def check_truth(truth: PictureTruth, size_px: tuple[int, int], ids: dict[Team, frozenset[int]]) -> None:
    """Raise SourceError when a picture's truth cannot be that of a venue.

    size_px: width and height of the venue's pictures; ids: the marker ids that each team's pattern has.
    """
    width, height = size_px
    if truth.size_px not in (None, size_px):
        found = f"image_size_px {list(truth.size_px or ())}"
        raise SourceError(truth.asked, found=found, accepted=f"the venue's {width}x{height} px")
    for name, x, y in _places(truth):
        if not (0.0 <= x <= width and 0.0 <= y <= height):
            accepted = f"points in the venue's picture of {width}x{height} px"
            raise SourceError(truth.asked, found=f"{name} at ({x:g}, {y:g})", accepted=accepted)
    for robot in truth.robots:
        if robot.id is not None and robot.id not in ids[robot.team]:
            accepted = f"ids of its pattern: {', '.join(map(str, sorted(ids[robot.team])))}"
            raise SourceError(truth.asked, found=f"robot {robot.team} {robot.id}", accepted=accepted)


def _places(truth: PictureTruth) -> Iterator[tuple[str, float, float]]:
    for robot in truth.robots:
        yield f"robot {robot.team} {'?' if robot.id is None else robot.id}", robot.x_px, robot.y_px
    for number, (x, y) in enumerate(truth.balls or (), start=1):
        yield f"ball {number}", x, y


def _picture(path: Path, name: str, table: Any) -> PictureTruth:
    asked = f"truth file {path}: {name}"
    if not isinstance(table, dict):
        raise SourceError(asked, found=repr(table), accepted="a table")
    form: type[_Single | _Listed] = _Single if table.keys() & set(_Single.__struct_fields__) else _Listed
    if foreign := sorted(table.keys() - set(form.__struct_fields__)):
        both = f"{', '.join(_Listed.__struct_fields__)}; or {', '.join(_Single.__struct_fields__)}"
        raise SourceError(asked, found=f"unknown keys {', '.join(foreign)}", accepted=both)
    for place, number in _numbers(table, ""):
        if not math.isfinite(number):
            raise SourceError(f"{asked}: {place}", found=str(number), accepted="a finite number")
    try:
        truth = msgspec.convert(table, form)
    except msgspec.ValidationError as error:
        message, _, place = str(error).partition(" - at ")
        where = f"{asked}: {place.strip('`').removeprefix('$.')}" if place else asked
        raise SourceError(where, found=message, accepted="see the two forms in docs/patterns.md") from None
    file = path.parent / name
    if isinstance(truth, _Single):
        return _from_single(file, truth, table, asked)
    robots = tuple(_robot(f"{asked}: robots[{i}]", robot) for i, robot in enumerate(truth.robots or ()))
    _check_once(asked, robots)
    teams = frozenset(Team) if truth.robots is not None else frozenset()
    return PictureTruth(file, robots, teams, truth.balls, truth.ignore, truth.image_size_px, asked)


def _from_single(file: Path, truth: _Single, table: dict[str, Any], asked: str) -> PictureTruth:
    places = ((Team.BLUE, truth.blue), (Team.YELLOW, truth.yellow))
    robots = tuple(TrueRobot(team, None, *place) for team, place in places if place is not None)
    balls = () if truth.ball is None else (truth.ball,)
    teams = frozenset(team for team in Team if team.value in table)
    return PictureTruth(file, robots, teams, balls if "ball" in table else None, (), None, asked)


def _robot(asked: str, robot: _Robot) -> TrueRobot:
    if robot.team not in list(Team):
        raise SourceError(f"{asked}.team", found=repr(robot.team), accepted=", ".join(Team))
    if (robot.center_px is None) == (robot.centre_px is None):
        found = "neither" if robot.center_px is None else "both"
        raise SourceError(asked, found=f"{found} of center_px and centre_px", accepted="one of them")
    place = robot.center_px or robot.centre_px
    assert place is not None
    return TrueRobot(Team(robot.team), robot.id, *place)


def _check_once(asked: str, robots: tuple[TrueRobot, ...]) -> None:
    """A robot with an id is in a picture once."""
    seen: dict[tuple[Team, int], int] = {}
    for index, robot in enumerate(robots):
        if robot.id is None:
            continue
        if (first := seen.setdefault((robot.team, robot.id), index)) != index:
            found = f"robot {robot.team} {robot.id}, which robots[{first}] is too"
            raise SourceError(f"{asked}: robots[{index}]", found=found, accepted="each robot once")


def _numbers(node: Any, place: str) -> Iterator[tuple[str, float]]:
    """Every float of a table, with its place, "robots[0].center_px[1]"."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from _numbers(value, f"{place}.{key}" if place else key)
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _numbers(value, f"{place}[{index}]")
    elif isinstance(node, float):
        yield place, node
