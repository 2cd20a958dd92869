"""Truth that cannot be is refused with its file, its place, what was found and what is accepted."""

import json
from pathlib import Path
from typing import Any

import pytest

from vision_core.errors import SourceError
from vision_core.evaluation.truth_files import check_truth, load_truth
from vision_core.types.objects import Team

IDS = {Team.BLUE: frozenset({1, 2}), Team.YELLOW: frozenset({3})}


def robot(team: str, number: int | None, x: float, y: float) -> dict[str, Any]:
    return {"team": team, "id": number, "center_px": [x, y]}


def check(tmp_path: Path, table: Any) -> None:
    path = tmp_path / "truth.json"
    path.write_text(json.dumps({"a.png": table}))
    for truth in load_truth(path):
        check_truth(truth, (640, 480), IDS)


def test_right_truth_is_accepted(tmp_path: Path) -> None:
    check(tmp_path, {"robots": [robot("blue", 1, 0, 0), robot("blue", None, 9, 9), robot("blue", None, 9, 9)]})
    check(tmp_path, {"blue": [640, 480], "yellow": None, "ball": [1.5, 2.5]})


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"robots": [robot("blue", 1, float("nan"), 5)]}, r"a.png: robots\[0\].center_px\[0\]; found: nan; .* finite"),
        ({"balls": [[1, 2], [float("inf"), 2]]}, r"a.png: balls\[1\]\[0\]; found: inf"),
        ({"robots": [robot("green", 1, 1, 1)]}, r"robots\[0\].team; found: 'green'; accepted: blue, yellow"),
        (
            {"robots": [robot("blue", 1, 1, 1), robot("blue", 1, 9, 9)]},
            r"robots\[1\]; found: robot blue 1, which robots",
        ),
        ({"robots": [robot("blue", 3, 1, 1)]}, r"a.png; found: robot blue 3; accepted: ids of its pattern: 1, 2"),
        ({"robots": [robot("blue", 1, 641, 1)]}, r"found: robot blue 1 at \(641, 1\); accepted: points in .* 640x480"),
        ({"balls": [[1, -2]]}, r"found: ball 1 at \(1, -2\)"),
        ({"blue": [-5, 1]}, r"found: robot blue \? at \(-5, 1\)"),
        ({"robots": [{"team": "blue"}]}, r"robots\[0\]; found: neither of center_px and centre_px"),
        ({"robots": [{"team": "blue", "center_px": "x"}]}, r"a.png: robots.*center_px; found: Expected"),
        ({"image_size_px": [10, 10]}, r"found: image_size_px \[10, 10\]; accepted: the venue's 640x480 px"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path: Path, table: Any, message: str) -> None:
    with pytest.raises(SourceError, match=message) as caught:
        check(tmp_path, table)
    assert str(tmp_path / "truth.json") in caught.value.asked


def test_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    path = tmp_path / "truth.json"
    path.write_bytes(b'\xef\xbb\xbf{"a.png": {"ball": null}}')
    assert load_truth(path)[0].balls == ()
