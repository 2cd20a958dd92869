"""Results of the experiment: tables beside the paper's, the causes of skipped frames, histograms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.web.charts.panels import BLUE, ORANGE, Panel, Series, counts_of, draw_panels
from bench.cambada.activation_log import Rows
from bench.cambada.paper import LOOPS, TASKS
from bench.cambada.picture import draw
from bench.cambada.results import Loop, Modular, execution_rows, intervals_ms, skipped_of, spread_of, table_1, table_3
from bench.clients import StallDetectors
from bench.load import full_load
from bench.scheduling import stall_test
from bench.service import is_alive

MS = 1_000_000


def rows_of(period_ms: float, count: int, jitter_ms: float = 0.0) -> Rows:
    """A task that runs for every frame and begins alternately jitter_ms early and late."""
    due = np.arange(1, count + 1) * round(period_ms * MS)
    began = due + np.where(np.arange(count) % 2, 1, -1) * round(jitter_ms * MS)
    number = np.arange(count)
    return np.column_stack([due, began, began + 3 * MS, number, number % 2]).astype(np.int64)


def modular_of(jitter_ms: float) -> Modular:
    tasks = {name: rows_of(timing.period_ms, 20, jitter_ms) for name, timing in TASKS.items()}
    policies = {name: f"FIFO {timing.priority}" for name, timing in TASKS.items()}
    return Modular(tasks, policies, lambda _start, _end: False)


LOOP = Loop("ordinary", rows_of(70.0, 30), rows_of(70.0, 30))


def test_intervals_are_between_beginnings() -> None:
    spread = spread_of(intervals_ms(rows_of(50.0, 21, 1.0)))
    assert (spread.max_ms, spread.min_ms, spread.sd_ms) == pytest.approx((52.0, 48.0, 2.0))
    assert spread.mean_ms == pytest.approx(50.0)


def test_the_spread_of_no_durations_is_an_error() -> None:
    with pytest.raises(ValueError, match="no durations"):
        spread_of(intervals_ms(rows_of(50.0, 1)))


def test_a_skipped_frame_is_attributed_to_the_task_unless_the_machine_stalled() -> None:
    rows = np.delete(rows_of(50.0, 10), (3, 7), axis=0)
    assert skipped_of(rows_of(50.0, 10), 50.0, lambda _start, _end: True).by_machine == 0
    busy = skipped_of(rows, 50.0, lambda _start, _end: False)
    assert (busy.by_task, busy.by_machine, busy.undelivered) == (2, 0, 0)
    stalled = skipped_of(rows, 50.0, lambda start, end: start < 0.2 < end)
    assert (stalled.by_task, stalled.by_machine) == (1, 1)


def test_a_frame_that_never_came_is_not_skipped() -> None:
    rows = np.delete(rows_of(50.0, 10), (3, 7), axis=0)
    rows[:, 3] = np.arange(len(rows))
    skipped = skipped_of(rows, 50.0, lambda _start, _end: False)
    assert (skipped.by_task, skipped.by_machine, skipped.undelivered) == (0, 0, 2)


def test_a_frame_that_was_processed_twice_is_not_skipped() -> None:
    rows = rows_of(50.0, 10)
    rows[5:, 3] -= 1
    assert skipped_of(rows, 50.0, lambda _start, _end: False).by_task == 0


def test_table_3_stands_beside_the_papers_and_judges_each_deviation() -> None:
    for jitter_ms, met in ((0.5, True), (40.0, False)):
        rows = list(table_3(modular_of(jitter_ms)))
        verdicts = {row["name"]: row["met"] for row in rows if row["name"].endswith("sd")}
        assert set(verdicts) == {f"table 3, {name}: interval, sd" for name in TASKS}
        assert verdicts["table 3, avoid_om: interval, sd"] is met
        paper = {row["name"]: row["baseline"] for row in rows if "baseline" in row}
        assert paper["table 3, kgoal: interval, max"] == 506.6
        skips = [row for row in rows if row["name"].endswith("skipped by the task")]
        assert [row["name"].partition(":")[0] for row in skips] == ["avoid_om", "avoid_fr", "ball_om", "ball_fr"]


def test_table_1_stands_beside_both_of_the_papers_loops() -> None:
    rows = {row["name"]: row for row in table_1(LOOP)}
    for name, paper in LOOPS.items():
        row = rows[f"table 1, one loop (ordinary) beside {name}: response, mean"]
        assert row["value"] == pytest.approx(3.0)
        assert row["baseline"] == paper.mean_ms
    assert rows["one loop (ordinary): frames skipped, of 30"]["value"] == 0


def test_every_task_is_listed_with_the_policy_that_it_was_granted() -> None:
    names = [row["name"] for row in execution_rows(modular_of(0.1))]
    assert any(name.startswith("avoid_om, every 50 ms + 0, FIFO 45, found in 50% of 20 runs") for name in names)


@given(st.lists(st.floats(-100.0, 100.0), max_size=50), st.integers(2, 20))
def test_every_value_is_counted_once(values: list[float], bins: int) -> None:
    edges = (*np.linspace(-20.0, 20.0, bins).tolist(), math.inf)
    counts = counts_of(values, edges)
    assert len(counts) == bins
    assert sum(counts) == len(values)
    assert counts[-1] == sum(value >= 20.0 for value in values)


def test_a_picture_has_every_panel_in_its_place() -> None:
    panel = Panel("p", "x [ms]", (0.0, 1.0, 2.0), (Series("a", (1, 0), BLUE), Series("b", (0, 1000), ORANGE)))
    image = draw_panels([panel, panel, panel], "title", 2, (400, 300))
    assert image.shape[1] == 800
    for color in (BLUE, ORANGE):
        there = np.argwhere((image == color).all(axis=2))
        assert {(row > 340, column > 400) for row, column in there.tolist()} == {
            (False, False), (False, True), (True, False),
        }  # fmt: skip


def test_the_smallest_count_is_visible_beside_the_largest() -> None:
    edges = (0.0, 1.0, 2.0)
    panel = Panel("p", "x", edges, (Series("a", (1, 0), BLUE), Series("b", (0, 100_000), ORANGE)), logarithmic=True)
    below_legend = draw_panels([panel], "", 1, (400, 300))[150:]
    assert (below_legend == BLUE).all(axis=2).any()


def test_all_figures_fit_into_one_picture() -> None:
    image = draw(LOOP, LOOP, modular_of(0.2), "title")
    assert image.shape[1] == 1600


@pytest.mark.parametrize(("policy", "stalled"), [("SCHED_FIFO", True), ("SCHED_OTHER", False)])
def test_only_a_detector_with_real_time_priority_shows_stalls(policy: str, stalled: bool) -> None:
    detectors = object.__new__(StallDetectors)
    detectors.reports = [{"policy": policy, "late": [[1.0, 0.5]]}]
    assert stall_test(detectors)(0.9, 1.1) is stalled
    assert stall_test(detectors)(1.1, 1.2) is False


@pytest.mark.slow
def test_the_load_ends_with_its_block() -> None:
    with full_load() as load:
        pids = [process.pid for process in load.processes.values()]
        assert all(map(is_alive, pids))
        assert set(load.shares()) == set(load.processes)
    assert not any(map(is_alive, pids))
