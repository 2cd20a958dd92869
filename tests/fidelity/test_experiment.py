"""A few worlds from end to end: both pictures are rendered, and what is told agrees with what is seen."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from app.cli import app
from bench.fidelity import CHUNK, batched_seeds, tally_rows
from vision_core.errors import SettingsError
from vision_core.fidelity.causes import Cause
from vision_core.fidelity.experiment import Tally, run
from vision_core.fidelity.options import measure, part_of
from vision_core.fidelity.reports import Report
from vision_core.fidelity.resolution import crossing_mm
from vision_core.fidelity.summary import numbers
from vision_core.fidelity.worlds import Setup, random_world
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.native.opencv import read_picture
from vision_core.protocol.messages import HIDDEN
from vision_core.protocol.options import Options

SEEDS = (1, 4, 7)


@pytest.fixture(scope="module")
def tally() -> Tally:
    return run("3 m", (320, 240), tall=False, seeds=SEEDS, show=lambda _: None, ceilings=("640x480",))["640x480"]


def test_the_simulated_view_is_like_the_real_one(tally: Tally) -> None:
    assert len(tally.comparisons) == len(SEEDS)
    assert tally.share_of_type() >= 0.97
    assert tally.share_within(1.0) >= 0.85
    assert tally.share_of(Cause.UNEXPLAINED) < 0.01


def test_every_disagreement_has_one_cause(tally: Tally) -> None:
    for comparison in tally.comparisons:
        disagree = ~comparison.agreement.agrees
        assert [cause is not None for cause in comparison.causes] == disagree.tolist()


def test_on_board_the_near_is_seen_better_than_the_far_and_from_the_ceiling_it_is_not(tally: Tally) -> None:
    near, far = ((110.0, 800.0), (800.0, 3200.0))
    assert tally.rms_mm("onboard_mm", *far) > 2.0 * tally.rms_mm("onboard_mm", *near)
    assert tally.rms_mm("ceiling_mm", *far) < tally.rms_mm("onboard_mm", *far)


def test_results_are_numbers_that_json_knows_and_rows_of_a_table(tally: Tally) -> None:
    found = json.loads(json.dumps(numbers(tally), allow_nan=False))
    assert found["worlds"] == len(SEEDS)
    assert sum(found["causes"].values()) == pytest.approx(
        np.mean([~each.agreement.agrees for each in tally.comparisons])
    )
    goals = [row["name"] for row in tally_rows(tally) if "goal" in row]
    assert {"type alike", "distance within 1 px", "unexplained"} <= set(goals)


def test_parts_of_an_experiment_are_counted_together(tally: Tally) -> None:
    whole = Tally(tally.setup)
    for seed, comparison in zip(SEEDS, tally.comparisons, strict=True):
        whole.extend(Tally(tally.setup, worlds=2, unserved=[seed + 1], comparisons=[comparison]))
    assert (whole.worlds, whole.unserved) == (2 * len(SEEDS), [seed + 1 for seed in SEEDS])
    assert whole.share_within(1.0) == tally.share_within(1.0)


@pytest.mark.parametrize("worlds", [1, CHUNK, 2 * CHUNK + 1])
def test_parts_have_every_world_once(worlds: int) -> None:
    parts = batched_seeds(7, worlds)
    assert [seed for part in parts for seed in part] == list(range(7, 7 + worlds))
    assert max(map(len, parts)) <= CHUNK


def test_equal_seeds_are_equal_worlds_without_contact() -> None:
    settings = Setup("3 m", "640x480", (320, 240), tall=False).settings
    first, again, other = (random_world(settings, seed).robots for seed in (5, 5, 6))
    assert (first == again).all()
    assert (first != other).any()
    gaps = np.hypot(*(first[:, None, :2] - first[None, :, :2]).transpose(2, 0, 1))
    assert gaps[~np.eye(len(first), dtype=bool)].min() > 0.18


def test_pixels_are_alike_where_the_paper_says() -> None:
    across, along = crossing_mm(PAPER_MIRROR, 5.0)
    assert across == pytest.approx(220.0, abs=2.0)
    assert along < across


def test_a_finer_mirror_and_finer_steps_are_told_less_exactly() -> None:
    rows = measure((1, 2), ("3 m",), ("640x480",))
    assert [(row.fov_deg, row.resolution_deg) for row in rows[:3]] == [(360.0, 1.0), (180.0, 0.5), (90.0, 0.25)]
    assert rows[0].equal > rows[3].equal
    assert all(row.same_type > 0.98 for row in rows)


def test_a_narrow_view_looks_ahead() -> None:
    report = Report(np.array(["w"] * 1440), np.arange(1440.0), HIDDEN)
    part = part_of(report, Options(version=2, fov_deg=90.0, center_deg=0.0, resolution_deg=0.25))
    assert part.radii_px[[0, 180, 359]].tolist() == [1260.0, 0.0, 179.0]


def test_the_command_draws_the_papers_figures(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["fidelity", "-o", str(tmp_path), "--seed", "1"], catch_exceptions=False)
    assert "type alike" in result.output
    assert json.loads((tmp_path / "numbers.json").read_text())["worlds"] == 1
    sizes = {name: read_picture(tmp_path / f"{name}.png").shape for name in ("figure-3", "figure-6", "figure-7")}
    assert sizes == {"figure-3": (480, 640, 3), "figure-6": (240, 320, 3), "figure-7": (240, 320, 3)}
    assert read_picture(tmp_path / "figures.png").shape[1] > 1280


@pytest.mark.parametrize("words", [["--field", "4 m"], ["--ceiling", "800x600"]])
def test_unknown_choices_are_refused(words: list[str], tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="accepted"):
        CliRunner().invoke(app, ["fidelity", "-o", str(tmp_path), *words], catch_exceptions=False)
