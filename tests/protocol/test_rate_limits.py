"""Token buckets, the shared budget, complaints, and the bounded table of addresses."""

from vision_core.clock import Instant, after
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.rate_limits import (
    COMMAND_RATE,
    DATAGRAM,
    RATES,
    SHARES,
    Rate,
    RateLimiter,
    RateLimiterTable,
    SharedBudget,
    TokenBucket,
)

START = Instant(10)


def test_a_bucket_lets_a_burst_pass_and_then_its_rate() -> None:
    bucket = TokenBucket(Rate(20.0, 40))
    assert sum(bucket.take(START) for _ in range(100)) == 40
    assert sum(bucket.take(after(START, 0.5)) for _ in range(100)) == 10
    assert sum(bucket.take(after(START, 1000.0)) for _ in range(100)) == 40


def test_a_clock_that_stands_or_goes_back_gains_nothing() -> None:
    bucket = TokenBucket(Rate(20.0, 1))
    assert bucket.take(after(START, 5.0))
    assert not bucket.take(START)


def test_each_command_has_a_budget_of_its_own() -> None:
    limiter = RateLimiter()
    assert sum(limiter.take("bye", START) for _ in range(1000)) == COMMAND_RATE.burst
    assert sum(limiter.take("init", START) for _ in range(1000)) == RATES["init"].burst
    assert sum(limiter.take(DATAGRAM, START) for _ in range(1000)) == RATES[DATAGRAM].burst


def test_an_address_alone_may_use_a_shared_budget_down_to_the_reserve() -> None:
    budget, limiter = SharedBudget("inits", Rate(160.0, 320)), RateLimiter()
    assert sum(budget.take(limiter, START) for _ in range(1000)) == 320 * SharedBudget.RESERVE
    assert sum(budget.take(RateLimiter(), START) for _ in range(1000)) == 320 * SharedBudget.RESERVE


def test_an_address_within_its_share_is_served_whatever_the_others_ask() -> None:
    budget = SharedBudget("inits", Rate(160.0, 320))
    greedy, modest = [RateLimiter() for _ in range(SHARES - 1)], RateLimiter()
    for turn in range(100):
        now = after(START, turn / 10)
        for limiter in greedy:
            for _ in range(100):
                budget.take(limiter, now)
        assert budget.take(modest, now)  # ten a second: one of sixteen shares
    assert not all(budget.take(modest, now) for _ in range(11))


def test_each_error_is_told_once_in_five_seconds() -> None:
    limiter = RateLimiter()
    assert limiter.may_complain(ErrorCode.NOT_ADMITTED, START)
    assert limiter.may_complain(ErrorCode.ILLEGAL_FORM, START)
    assert not limiter.may_complain(ErrorCode.NOT_ADMITTED, after(START, 4.9))
    assert limiter.may_complain(ErrorCode.NOT_ADMITTED, after(START, 5.0))


def test_the_least_recently_used_address_is_dropped() -> None:
    limiters = RateLimiterTable(max_sources=3)
    first, second = limiters.of("a"), limiters.of("b")
    limiters.of("c")
    assert limiters.of("a") is first
    limiters.of("d")
    assert len(limiters) == 3
    assert limiters.of("a") is first
    assert limiters.of("b") is not second
