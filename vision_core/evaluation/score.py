"""Scores sightings in pictures against their truth: what ``pslv evaluate`` prints.

Found and true objects are paired one to one within a tolerance: as many pairs as possible, then as near as possible. A
robot pairs with one of its team, and of its id where the truth gives one; a wrong id is one missed and one false.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vision_core.errors import SourceError
from vision_core.evaluation.assignment import best_pairs
from vision_core.evaluation.stills import detect_files
from vision_core.evaluation.truth_files import PictureTruth, TrueRobot, check_truth
from vision_core.geometry import Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import Color, draw_circle, draw_text, read_picture, write_picture
from vision_core.patterns.worn import worn_patterns
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team

Found = dict[str, Any]
"""A sighting as ``detect_files`` gives it."""

RIGHT_COLOR, MISSED_COLOR, FALSE_COLOR = (60, 230, 60), (40, 40, 255), (255, 60, 255)
RING_PX = 14.0


@dataclass(slots=True)
class Score:
    """Counts of one kind of object; sums over pictures with ``add``."""

    true: int = 0
    found: int = 0
    hits: int = 0
    squares_px2: float = 0.0

    def add(self, other: "Score") -> None:
        """Count another one's objects too."""
        self.true += other.true
        self.found += other.found
        self.hits += other.hits
        self.squares_px2 += other.squares_px2

    def table(self) -> dict[str, float | int | None]:
        """``{"recall", "precision", "rms_px", "n"}``; null where nothing was to be found, or nothing was."""
        return {
            "recall": self.hits / self.true if self.true else None,
            "precision": self.hits / self.found if self.found else None,
            "rms_px": math.sqrt(self.squares_px2 / self.hits) if self.hits else None,
            "n": self.true,
        }


@dataclass(slots=True)
class PictureScore:
    """The result of one picture."""

    file: Path
    robots: Score
    balls: Score
    missed: list[tuple[str, float, float]] = field(default_factory=list)
    """True objects without a pair: name, x, y [px]."""
    false: list[tuple[str, float, float]] = field(default_factory=list)
    right: list[tuple[str, float, float]] = field(default_factory=list)
    wrong_ids: int = 0
    reasons: list[str] = field(default_factory=list)


def evaluate(
    truth: Sequence[PictureTruth], settings: Settings, tolerance_px: float, draw: Path | None = None
) -> Iterator[PictureScore]:
    """The score of every picture, as it is done. draw: folder for overlays, in which misses are marked.

    Raises SourceError before the first picture for truth that cannot be the venue's, and for a picture that cannot be
    read or has not the venue's size; SettingsError for a pattern that cannot be read.
    """
    camera = CameraSetup.from_settings(settings).size_px
    ids = {
        team: frozenset(number for pattern in worn_patterns(settings.robots, team) for number in pattern.code_by_id)
        for team in Team
    }
    for picture in truth:
        check_truth(picture, camera, ids)
    found = detect_files([picture.file for picture in truth], settings, draw)
    for picture, table in zip(truth, found, strict=True):
        if "error" in table:
            raise SourceError(str(table["error"]))
        score = score_picture(picture, table, tolerance_px)
        if draw is not None:
            _mark(draw / f"{picture.file.stem}.png", score)
        yield score


def score_picture(truth: PictureTruth, found: dict[str, Any], tolerance_px: float) -> PictureScore:
    """How well what was found in a picture, a table of ``detect_files``, pairs with the truth."""
    score = PictureScore(truth.file, Score(), Score(), reasons=list(found["reasons"]))
    robots = [robot for robot in found["robots"] if robot["team"] in truth.teams_scored]
    distances = _distances([(robot.x_px, robot.y_px) for robot in truth.robots], robots)
    allowed = np.array([[_may_be(true, one) for one in robots] for true in truth.robots], dtype=np.bool_)
    gated = np.where(allowed.reshape(distances.shape), distances, math.inf)
    names = [_name(true.team, true.id) for true in truth.robots]
    places = [(name, true.x_px, true.y_px) for name, true in zip(names, truth.robots, strict=True)]
    found_names = [_name(one["team"], one["id"]) for one in robots]
    pairs = best_pairs(gated, tolerance_px)
    _count(score, score.robots, places, _named(found_names, robots), distances, pairs, truth)
    score.wrong_ids = _wrong_ids(truth.robots, robots, distances, pairs, tolerance_px)
    if truth.balls is not None:
        balls = found["balls"]
        distances = _distances(truth.balls, balls)
        places = [("ball", x, y) for x, y in truth.balls]
        pairs = best_pairs(distances, tolerance_px)
        _count(score, score.balls, places, _named(["ball"] * len(balls), balls), distances, pairs, truth)
    return score


def total(scores: Iterable[PictureScore]) -> dict[str, Any]:
    """``{"robots", "balls", "all", "wrong_id"}`` over pictures."""
    robots, balls, both, wrong = Score(), Score(), Score(), 0
    for score in scores:
        robots.add(score.robots)
        balls.add(score.balls)
        both.add(score.robots)
        both.add(score.balls)
        wrong += score.wrong_ids
    return {"robots": robots.table(), "balls": balls.table(), "all": both.table(), "wrong_id": wrong}


def _may_be(true: TrueRobot, one: Found) -> bool:
    return bool(one["team"] == true.team) and true.id in (None, one["id"])


def _wrong_ids(
    true: Sequence[TrueRobot], robots: list[Found], distances: Floats, pairs: list[tuple[int, int]], tolerance: float
) -> int:
    """Robots of the right team and place whose id was read wrong; one that was not read is not among them."""
    left = distances.copy()
    for row, column in pairs:
        left[row, :] = left[:, column] = math.inf
    for row, column in np.ndindex(*left.shape):
        if robots[column]["team"] != true[row].team or robots[column]["id"] is None:
            left[row, column] = math.inf
    return len(best_pairs(left, tolerance))


def _count(
    score: PictureScore, kind: Score, true: list[tuple[str, float, float]], found: list[tuple[str, float, float]],
    distances: Floats, pairs: list[tuple[int, int]], truth: PictureTruth,
) -> None:  # fmt: skip
    hit, paired = {row for row, _ in pairs}, {column for _, column in pairs}
    false = [one for i, one in enumerate(found) if i not in paired and not _ignored(truth, one[1], one[2])]
    score.missed += [one for i, one in enumerate(true) if i not in hit]
    score.false += false
    score.right += [found[column] for _, column in pairs]
    kind.true, kind.hits = len(true), len(pairs)
    kind.found = len(pairs) + len(false)
    kind.squares_px2 = float(sum(distances[pair] ** 2 for pair in pairs))


def _ignored(truth: PictureTruth, x: float, y: float) -> bool:
    return any(left <= x <= right and top <= y <= bottom for left, top, right, bottom in truth.ignore)


def _distances(true: Sequence[tuple[float, float]], found: list[Found]) -> Floats:
    places = np.array(true, dtype=np.float64).reshape(-1, 1, 2)
    others = np.array([(one["x_px"], one["y_px"]) for one in found], dtype=np.float64).reshape(1, -1, 2)
    steps = places - others
    distances: Floats = np.hypot(steps[..., 0], steps[..., 1])
    return distances


def _named(names: list[str], found: list[Found]) -> list[tuple[str, float, float]]:
    return [(name, one["x_px"], one["y_px"]) for name, one in zip(names, found, strict=True)]


def _name(team: str, number: int | None) -> str:
    return f"{team} {'?' if number is None else number}"


def _mark(overlay: Path, score: PictureScore) -> None:
    """Draw rings round right, missed and false objects in the overlay that ``detect_files`` drew."""
    canvas = read_picture(overlay)
    marks: tuple[tuple[str, Color, list[tuple[str, float, float]]], ...] = (
        ("", RIGHT_COLOR, score.right),
        ("missed ", MISSED_COLOR, score.missed),
        ("false ", FALSE_COLOR, score.false),
    )
    for word, color, things in marks:
        for name, x, y in things:
            draw_circle(canvas, (x, y), RING_PX, color, 1 if not word else 2)
            if word:
                draw_text(canvas, word + name, (x + RING_PX + 2, y + RING_PX), color, 0.4)
    write_picture(overlay, canvas)
