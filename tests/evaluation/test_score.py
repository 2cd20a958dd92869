"""Scoring: one to one, by team and id, within a tolerance; foreign truth is refused by name."""

import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from vision_core.errors import SourceError
from vision_core.evaluation.assignment import best_pairs
from vision_core.evaluation.score import PictureScore, score_picture, total
from vision_core.evaluation.truth_files import load_truth
from vision_core.geometry import Floats

SMALL = arrays(np.float64, st.tuples(st.integers(0, 4), st.integers(0, 4)), elements=st.floats(0, 20))


@given(SMALL)
def test_no_pairing_is_better(distances: Floats) -> None:
    pairs = best_pairs(distances, 15.0)
    rows, columns = [row for row, _ in pairs], [column for _, column in pairs]
    assert len(set(rows)) == len(rows)
    assert len(set(columns)) == len(columns)
    assert all(distances[pair] <= 15.0 for pair in pairs)
    best = max(_values(distances), default=(0, 0.0))
    assert (len(pairs), -sum(distances[pair] for pair in pairs)) == pytest.approx(best, abs=1e-6)


def _values(distances: Floats) -> list[tuple[int, float]]:
    """Number of pairs and minus the sum of distances, of every pairing."""
    if distances.shape[0] > distances.shape[1]:
        distances = distances.T
    n, m = distances.shape
    values = []
    for columns in itertools.permutations(range(m), n):
        near = [distances[pair] for pair in enumerate(columns) if distances[pair] <= 15.0]
        values.append((len(near), -sum(near)))
    return values


def truth_of(folder: Path, picture: Any) -> Any:
    file = folder / "truth.json"
    file.write_text(json.dumps({"one.png": picture}))
    return load_truth(file)[0]


def robot(team: str, number: int | None, x: float, y: float) -> dict[str, Any]:
    return {"team": team, "id": number, "x_px": x, "y_px": y}


def found(*robots: dict[str, Any], balls: tuple[tuple[float, float], ...] = ()) -> dict[str, Any]:
    return {"robots": list(robots), "balls": [{"x_px": x, "y_px": y} for x, y in balls], "reasons": ["dark"]}


def scored(folder: Path, picture: Any, table: dict[str, Any]) -> PictureScore:
    return score_picture(truth_of(folder, picture), table, 15.0)


LISTED = {
    "robots": [
        {"team": "blue", "id": 3, "center_px": [100, 100]},
        {"team": "yellow", "centre_px": [200, 100]},
    ],
    "balls": [[50, 50]],
    "ignore": [[300, 300, 400, 400]],
    "note": "by eye",
}


def test_everything_right(tmp_path: Path) -> None:
    table = found(robot("blue", 3, 103, 104), robot("yellow", 9, 200, 100), balls=((50, 50),))
    sums = total([scored(tmp_path, LISTED, table)])
    assert sums == {
        "robots": {"recall": 1.0, "precision": 1.0, "rms_px": pytest.approx(math.sqrt(12.5)), "n": 2},
        "balls": {"recall": 1.0, "precision": 1.0, "rms_px": 0.0, "n": 1},
        "all": {"recall": 1.0, "precision": 1.0, "rms_px": pytest.approx(math.sqrt(25 / 3)), "n": 3},
        "wrong_id": 0,
    }


@pytest.mark.parametrize(
    ("one", "wrong"),
    [
        (robot("blue", 4, 100, 100), 1),
        (robot("blue", None, 100, 100), 0),
        (robot("yellow", 3, 100, 100), 0),
        (robot("blue", 3, 100, 116), 0),
    ],
)
def test_a_robot_of_another_id_team_or_place_is_no_hit(tmp_path: Path, one: dict[str, Any], wrong: int) -> None:
    score = scored(tmp_path, LISTED, found(one))
    assert (score.robots.true, score.robots.found, score.robots.hits, score.wrong_ids) == (2, 1, 0, wrong)
    assert [name for name, _, _ in score.missed] == ["blue 3", "yellow ?", "ball"]
    assert score.reasons == ["dark"]


def test_a_robot_found_twice_is_once_false(tmp_path: Path) -> None:
    score = scored(tmp_path, LISTED, found(robot("yellow", None, 201, 100), robot("yellow", None, 199, 100)))
    assert (score.robots.hits, score.robots.found) == (1, 2)


def test_ignored_regions_hold_nothing_false(tmp_path: Path) -> None:
    table = found(robot("blue", 3, 350, 350), balls=((350, 350), (250, 250)))
    score = scored(tmp_path, LISTED, table)
    assert (score.robots.found, score.balls.found) == (0, 1)
    assert score.false == [("ball", 250, 250)]


def test_single_form_and_what_is_null(tmp_path: Path) -> None:
    table = found(robot("yellow", None, 136, 262), robot("blue", None, 10, 10), balls=((5, 5),))
    score = scored(tmp_path, {"ball": None, "yellow": [136, 262], "blue": None}, table)
    assert (score.robots.true, score.robots.found, score.robots.hits) == (1, 2, 1)
    assert (score.balls.true, score.balls.found) == (0, 1)
    assert total([score])["balls"] == {"recall": None, "precision": 0.0, "rms_px": None, "n": 0}


def test_what_is_not_listed_is_not_scored(tmp_path: Path) -> None:
    score = scored(tmp_path, {"robots": []}, found(balls=((5, 5),)))
    assert (score.balls.found, score.false) == (0, [])
    score = scored(tmp_path, {"ball": [5, 5]}, found(robot("blue", 1, 9, 9), balls=((5, 5),)))
    assert (score.balls.hits, score.robots.found) == (1, 0)


@pytest.mark.parametrize(
    ("picture", "complaint"),
    [
        ({"robots": [], "bals": [], "hue": 3}, "one.png; found: unknown keys bals, hue; accepted: robots, balls"),
        ({"ball": None, "robots": []}, "unknown keys robots"),
        ({"robots": [{"team": "red", "center_px": [1, 2]}]}, "robots[0].team; found: 'red'; accepted: blue, yellow"),
        ({"robots": [{"team": "blue", "center_px": [1, 2], "angle": 3}]}, "unknown field `angle`"),
        ({"robots": [{"team": "blue"}]}, "found: neither of center_px and centre_px"),
        ({"balls": [[1]]}, "of length 2"),
        ([], "accepted: a table"),
    ],
)
def test_foreign_truth_is_refused(tmp_path: Path, picture: Any, complaint: str) -> None:
    with pytest.raises(SourceError) as refusal:
        truth_of(tmp_path, picture)
    assert complaint in str(refusal.value)


@pytest.mark.parametrize("text", ["", "[]", "{}", "nul", "[" * 100_000])
def test_no_truth_at_all(tmp_path: Path, text: str) -> None:
    file = tmp_path / "truth.json"
    file.write_text(text)
    with pytest.raises(SourceError, match=r"truth\.json"):
        load_truth(file)
    with pytest.raises(SourceError, match="No such file"):
        load_truth(tmp_path / "none.json")
