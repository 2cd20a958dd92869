"""Truth of pictures, read by eye: which robots and balls each of them shows, and where [px].

Two forms, per picture (``docs/patterns.md`` has them for people)::

    {"robots": [{"team": "blue", "id": 3, "center_px": [833, 353]}], "balls": [[510, 300]], "ignore": [[0, 0, 90, 40]]}
    {"blue": [701, 290], "yellow": [101, 137], "ball": null}

What is not listed at all is not scored; what is listed as null or empty is not there, and finding it is wrong.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from vision_core.errors import SourceError
from vision_core.settings.schema import Point2, Record
from vision_core.types.objects import Team

Box = tuple[float, float, float, float]
"""Left, top, right, bottom [px]."""


@dataclass(frozen=True, slots=True)
class TrueRobot:
    """A robot; id None where the truth does not say it."""

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
    """None: not scored."""
    ignore: tuple[Box, ...]
    size_px: tuple[int, int] | None


class _Robot(Record, frozen=True):
    team: Team
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
    """The truth of every picture of a file, in its order; pictures lie relative to it. Raises SourceError."""
    try:
        pictures = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SourceError(f"truth file {path}", found=error.strerror or str(error)) from None
    except (ValueError, RecursionError) as error:
        raise SourceError(f"truth file {path}", found=str(error), accepted="JSON") from None
    if not isinstance(pictures, dict) or not pictures:
        raise SourceError(f"truth file {path}", found="no pictures", accepted='{"PICTURE": {...}, ...}')
    return [_picture(path, name, table) for name, table in pictures.items()]


def _picture(path: Path, name: str, table: Any) -> PictureTruth:
    asked = f"truth file {path}: {name}"
    if not isinstance(table, dict):
        raise SourceError(asked, found=repr(table)[:60], accepted="a table")
    form: type[_Single | _Listed] = _Single if table.keys() & set(_Single.__struct_fields__) else _Listed
    if foreign := sorted(table.keys() - set(form.__struct_fields__)):
        both = f"{', '.join(_Listed.__struct_fields__)}; or {', '.join(_Single.__struct_fields__)}"
        raise SourceError(asked, found=f"foreign keys {', '.join(foreign)}", accepted=both)
    try:
        truth = msgspec.convert(table, form)
    except msgspec.ValidationError as error:
        raise SourceError(asked, found=str(error)) from None
    file = path.parent / name
    if isinstance(truth, _Single):
        return _from_single(file, truth, table)
    robots = tuple(_robot(asked, robot) for robot in truth.robots or ())
    teams = frozenset(Team) if truth.robots is not None else frozenset()
    return PictureTruth(file, robots, teams, truth.balls, truth.ignore, truth.image_size_px)


def _from_single(file: Path, truth: _Single, table: dict[str, Any]) -> PictureTruth:
    places = ((Team.BLUE, truth.blue), (Team.YELLOW, truth.yellow))
    robots = tuple(TrueRobot(team, None, *place) for team, place in places if place is not None)
    balls = () if truth.ball is None else (truth.ball,)
    teams = frozenset(team for team in Team if team.value in table)
    return PictureTruth(file, robots, teams, balls if "ball" in table else None, (), None)


def _robot(asked: str, robot: _Robot) -> TrueRobot:
    if (robot.center_px is None) == (robot.centre_px is None):
        raise SourceError(asked, found="a robot with both or none", accepted="center_px (or centre_px)")
    place = robot.center_px or robot.centre_px
    assert place is not None
    return TrueRobot(robot.team, robot.id, *place)
