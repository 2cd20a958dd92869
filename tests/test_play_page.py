"""docs/play.md holds: its controller is what a new team copies, and its lists are complete."""

import math
import re
from pathlib import Path

import pytest

from tests.client.pitch import Pitch
from vision_core.client.play.controllers import load_controller
from vision_core.types.objects import Team

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "play.md").read_text(encoding="utf-8")
ME = Team.YELLOW, 2


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_pages_controller_reaches_the_ball_and_kicks_it(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    (tmp_path / "our_team.py").write_text(code)
    monkeypatch.chdir(tmp_path)
    pitch = Pitch(
        {ME: load_controller("our_team.py:OurTeam")}, late=2, synthetic__seed=seed, synthetic__speed_m_s=0.0,
        synthetic__robots_per_team=2,
    )  # fmt: skip
    speeds: list[float] = []
    pitch.play(10.0, lambda truth: speeds.append(math.hypot(*truth.ball[3:5])))
    assert max(speeds) > 3.0


def test_the_page_names_every_example_that_plays() -> None:
    named = set(re.findall(r"^\| `(\w+\.py)`", PAGE, flags=re.MULTILINE))
    plays = {path.name for path in (ROOT / "examples").glob("*.py") if "Robot" in path.read_text(encoding="utf-8")}
    assert named == plays
