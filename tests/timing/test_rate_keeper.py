"""The rate keeper stays on its grid, skips periods that have passed, and never makes up for them."""

from vision_core.clock import NS_PER_S, Instant, ManualClock
from vision_core.timing.rate_keeper import RateKeeper, RequestedKeeper, rate_keeper


def test_instants_lie_on_the_grid_without_drift() -> None:
    clock = ManualClock(Instant(5))
    keeper = RateKeeper(30.0, clock, clock.advance)
    instants = [keeper.wait() for _ in range(3001)]
    assert instants == [5 + round(k * NS_PER_S / 30.0) for k in range(3001)]
    assert keeper.skipped == 0


def test_work_within_the_period_shifts_nothing() -> None:
    clock = ManualClock()
    keeper = RateKeeper(10.0, clock, clock.advance)
    instants = []
    for _ in range(5):
        instants.append(keeper.wait())
        clock.advance(0.07)
    assert instants == [k * NS_PER_S // 10 for k in range(5)]


def test_lateness_skips_whole_periods_without_a_burst_afterwards() -> None:
    clock = ManualClock()
    keeper = RateKeeper(10.0, clock, clock.advance)
    keeper.wait()
    clock.advance(0.35)
    assert keeper.wait() == 4 * NS_PER_S // 10
    assert (keeper.number, keeper.skipped) == (4, 3)
    before = clock.now()
    assert keeper.wait() - before == NS_PER_S // 10
    assert keeper.skipped == 3


def test_a_sleep_that_wakes_early_is_taken_up_again() -> None:
    clock = ManualClock()
    keeper = RateKeeper(10.0, clock, lambda duration_s: clock.advance(min(duration_s, 0.03)))
    keeper.wait()
    assert keeper.wait() <= clock.now()


def test_unpaced_time_is_virtual_and_begins_now() -> None:
    clock = ManualClock(Instant(7))
    keeper = rate_keeper(1.0, clock, paced=False)
    assert [keeper.wait() for _ in range(3)] == [7, 7 + NS_PER_S, 7 + 2 * NS_PER_S]
    assert clock.now() == 7


def test_a_keeper_by_request_counts_periods_by_their_instants() -> None:
    keeper = RequestedKeeper(50.0)
    numbers = []
    for ms in (1000, 1020, 1080, 1081, 2000):  # the fourth after whoever orders began anew
        keeper.request(Instant(ms * 1_000_000))
        assert keeper.choose() == keeper.sleep() == keeper.wait() == Instant(ms * 1_000_000)
        numbers.append(keeper.number)
    assert numbers == [0, 1, 4, 4, 50]
    assert keeper.skipped == 0
