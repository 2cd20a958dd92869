"""Histograms: bins follow each other without gaps, quantiles lie where they should."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.timing.histogram import BINS, EDGES_S, Histograms, bin_of, decode, quantile_s, size_of


@given(st.integers(min_value=0, max_value=16 * 10**9))
def test_a_duration_lies_in_its_bin(duration_ns: int) -> None:
    number = bin_of(duration_ns)
    assert EDGES_S[number] <= duration_ns / 1e9 + 1e-18
    assert duration_ns / 1e9 < EDGES_S[number + 1] + 1e-18


def test_bins_are_ordered_and_three_percent_wide() -> None:
    assert (np.diff(EDGES_S) > 0.0).all()
    assert (EDGES_S[2:] / EDGES_S[1:-1]).max() <= 33.0 / 32.0 + 1e-12


def test_the_outer_bins_contain_everything_beyond() -> None:
    assert bin_of(-5) == 0
    assert bin_of(10**14) == BINS - 1


def test_quantiles_agree_with_numpys_to_a_bin() -> None:
    durations = np.random.default_rng(3).lognormal(np.log(2e6), 0.6, 20_000).astype(int)
    histograms = Histograms(["a", "b"])
    for duration in durations.tolist():
        histograms.add("b", duration)
    counts = decode(["a", "b"], histograms.encode())
    assert counts["a"].sum() == 0
    for share in (0.01, 0.5, 0.9, 0.99, 0.999):
        found = quantile_s(counts["b"], share)
        assert found == pytest.approx(np.quantile(durations, share) / 1e9, rel=0.035)
    assert quantile_s(counts["a"], 0.5) is None


def test_a_block_has_the_announced_size() -> None:
    assert len(Histograms("abc").encode()) == size_of("abc")
    with pytest.raises(ValueError, match="reshape"):
        decode("ab", Histograms("abc").encode())
