"""Buckets, complaints and the bounded table of sources."""

from vision_core.clock import Instant, after
from vision_core.protocol.error_codes import ErrorName
from vision_core.protocol.rate_limits import Allowance, Sources, TokenBucket

START = Instant(10)


def test_a_bucket_lets_through_a_burst_and_then_its_rate() -> None:
    bucket = TokenBucket(20.0, 40)
    assert sum(bucket.take(START) for _ in range(100)) == 40
    assert sum(bucket.take(after(START, 0.5)) for _ in range(100)) == 10
    assert sum(bucket.take(after(START, 1000.0)) for _ in range(100)) == 40


def test_a_clock_that_stands_or_falls_back_gains_nothing() -> None:
    bucket = TokenBucket(20.0, 1)
    assert bucket.take(after(START, 5.0))
    assert not bucket.take(START)


def test_each_error_is_told_once_in_five_seconds() -> None:
    allowance = Allowance()
    assert allowance.may_complain(ErrorName.NOT_ADMITTED, START)
    assert allowance.may_complain(ErrorName.ILLEGAL_FORM, START)
    assert not allowance.may_complain(ErrorName.NOT_ADMITTED, after(START, 4.9))
    assert allowance.may_complain(ErrorName.NOT_ADMITTED, after(START, 5.0))


def test_the_least_recently_used_source_is_forgotten() -> None:
    sources = Sources(most=3)
    first, second = sources.of("a"), sources.of("b")
    sources.of("c")
    assert sources.of("a") is first
    sources.of("d")
    assert len(sources) == 3
    assert sources.of("a") is first
    assert sources.of("b") is not second
