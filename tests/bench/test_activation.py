"""Statistics of activation instants."""

import numpy as np
import pytest

from bench.activation import BASELINES_AFTER_MS, PERIOD_MS, TASKS, regularity_of
from vision_core.clock import NS_PER_MS

PERIOD_NS = PERIOD_MS * NS_PER_MS


def test_a_grid_is_regular() -> None:
    grid = np.arange(1001, dtype=np.float64) * PERIOD_NS
    regularity = regularity_of([grid, grid + 7.0])
    assert regularity.intervals == 2000
    assert regularity.deviation_us == pytest.approx(0.0, abs=1e-6)
    assert regularity.excluded == 20
    assert regularity.skipped == 0


def test_a_late_activation_is_excluded_and_given_as_the_worst() -> None:
    late = np.arange(1001, dtype=np.float64) * PERIOD_NS
    late[500] += 3 * NS_PER_MS
    regularity = regularity_of([late])
    assert regularity.deviation_us == pytest.approx(0.0, abs=1e-6)
    assert regularity.worst_us == pytest.approx(3000.0)


def test_the_deviation_of_noise_is_measured() -> None:
    generator = np.random.default_rng(1)
    grid = np.arange(20001, dtype=np.float64) * PERIOD_NS + generator.uniform(0.0, 1e5, 20001)
    assert regularity_of([grid]).deviation_us == pytest.approx(
        100.0 / np.sqrt(6.0), rel=0.05
    )  # of a triangular distribution


def test_a_release_without_an_activation_is_counted() -> None:
    grid = np.delete(np.arange(1001, dtype=np.float64) * PERIOD_NS, [10, 20, 21])
    assert regularity_of([grid]).skipped == 3


@pytest.mark.parametrize("after_ms", BASELINES_AFTER_MS)
def test_no_task_or_baseline_has_the_offset_of_another(after_ms: int) -> None:
    offsets = [offset for task in TASKS for offset in (task.offset_ms, task.offset_ms + after_ms)]
    assert len({offset % PERIOD_MS for offset in offsets}) == len(offsets)
