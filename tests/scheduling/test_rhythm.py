"""The rhythm of releases: learned, lost, found again."""

from collections.abc import Sequence

import pytest

from vision_core.clock import NS_PER_MS, Instant
from vision_core.scheduling.rhythm import KEPT, LEAST, Rhythm

PERIOD_NS = 33 * NS_PER_MS


def rhythm_of(intervals_ns: Sequence[int]) -> tuple[Rhythm, Instant]:
    rhythm, at = Rhythm(), Instant(10**9)
    rhythm.note(at)
    for interval_ns in intervals_ns:
        at = Instant(at + interval_ns)
        rhythm.note(at)
    return rhythm, at


def test_a_few_releases_are_no_rhythm() -> None:
    rhythm, _ = rhythm_of([PERIOD_NS] * (LEAST - 1))
    assert rhythm.due is None


def test_the_next_release_comes_a_period_after_the_last() -> None:
    rhythm, last = rhythm_of([PERIOD_NS] * 20)
    assert rhythm.due == last + PERIOD_NS


def test_releases_that_come_a_little_early_or_late_keep_the_rhythm() -> None:
    jitter_ns = 3 * NS_PER_MS
    rhythm, last = rhythm_of([PERIOD_NS + (jitter_ns if number % 2 else -jitter_ns) for number in range(20)])
    assert rhythm.due is not None
    assert abs(rhythm.due - last - PERIOD_NS) <= jitter_ns


@pytest.mark.parametrize("wrong", [0.4, 1.6, 2.0])
def test_one_that_is_off_by_more_than_half_a_period_ends_it_for_a_while(wrong: float) -> None:
    before = [PERIOD_NS] * 20
    assert rhythm_of([*before, round(wrong * PERIOD_NS)])[0].due is None
    assert rhythm_of([*before, round(wrong * PERIOD_NS), *[PERIOD_NS] * KEPT])[0].due is not None


def test_another_rate_is_learned() -> None:
    rhythm, last = rhythm_of([PERIOD_NS] * 20 + [PERIOD_NS // 4] * KEPT)
    assert rhythm.due == last + PERIOD_NS // 4
