"""Ratios of quantiles and their confidence intervals, and the blocks that frames are histogram_of in."""

import numpy as np
import pytest

from bench.dashboards import Block, arm_of, histogram_of, ratio_interval
from bench.frame_path import FRAMES, SIGHTINGS, VIEWS
from vision_core.clock import NS_PER_MS, Instant
from vision_core.timing.histogram import BINS, Counts, quantile_s


def blocks_of(scale_ms: float, seed: int, count: int = 6) -> list[Counts]:
    generator = np.random.default_rng(seed)
    return [
        histogram_of((generator.gamma(9.0, scale_ms / 9.0, 500) * NS_PER_MS).astype(int).tolist()) for _ in range(count)
    ]


def test_equal_arms_have_a_ratio_of_one_within_the_interval() -> None:
    low, high = ratio_interval(blocks_of(1.0, 1), blocks_of(1.0, 2), 0.99)
    assert low < 1.0 < high


def test_the_interval_contains_the_ratio_of_a_slower_arm() -> None:
    low, high = ratio_interval(blocks_of(1.5, 1), blocks_of(1.0, 2), 0.99)
    assert 1.2 < low < 1.5 < high < 1.8


def test_a_frame_counts_in_the_block_in_which_it_was_done() -> None:
    frames = [(number, number + 10_000) for number in range(0, 100_000_000, 5_000_000)]
    later = [(number, at + 2_000_000) for number, at in frames]
    none = {task: np.zeros(BINS, dtype=np.uint64) for task in ("perceive", "serve")}
    block = Block(0, Instant(50_000_000), Instant(100_000_000), none)
    arm = arm_of([block], {FRAMES: frames, SIGHTINGS: later, VIEWS: later})
    latencies = arm["frame published -> last datagram sent"][0]
    assert latencies.sum() == 10
    assert quantile_s(latencies, 0.5) == pytest.approx(0.002, rel=0.05)
