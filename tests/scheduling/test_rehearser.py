"""When a task rehearses: before each regular release, never twice, never without time, and it gives way."""

from dataclasses import replace

import pytest

from vision_core.clock import NS_PER_MS, NS_PER_S, Instant, ManualClock
from vision_core.rtdb.infos import Rehearsals
from vision_core.scheduling.rehearser import FIRST_LEAD_NS, KEPT, MARGIN_NS, WATCH_NS, GiveWay, Rehearser

PERIOD_NS = 33 * NS_PER_MS
RUN_NS = NS_PER_MS


class Player:
    """A task that is released with a period and takes RUN_NS for a rehearsal."""

    def __init__(self, run_ns: int = RUN_NS) -> None:
        self.clock = ManualClock(Instant(10**9))
        self.run_ns = run_ns
        self.gives_way = False
        self.rehearser = Rehearser(self.rehearse, self.clock)
        self.due = self.clock.now()

    def rehearse(self, give_way: GiveWay) -> bool:
        if give_way():
            return False
        self.clock.advance(self.run_ns / NS_PER_S)
        return True

    def release(self, times: int = 1) -> None:
        for _ in range(times):
            self.clock.advance((self.due - self.clock.now()) / NS_PER_S)
            self.rehearser.released(self.clock.now())
            self.due = Instant(self.clock.now() + PERIOD_NS)

    def begin(self) -> Instant | None:
        return self.rehearser.begin(self.clock.now())

    def play(self) -> None:
        """Rehearse when it is time, then be released."""
        begin = self.begin()
        assert begin is not None
        self.clock.advance((begin - self.clock.now()) / NS_PER_S)
        assert self.rehearser.rehearse(lambda: self.gives_way) == self.due + WATCH_NS
        self.release()


def playing(run_ns: int = RUN_NS) -> Player:
    player = Player(run_ns)
    player.release(10)
    return player


def test_without_a_rhythm_there_is_none() -> None:
    player = Player()
    player.release(2)
    assert player.begin() is None
    assert player.rehearser.counts.skipped == 0


def test_it_begins_so_early_that_it_ends_before_the_release() -> None:
    player = playing()
    assert player.begin() == player.due - FIRST_LEAD_NS - MARGIN_NS
    for _ in range(KEPT):
        player.play()
    assert player.begin() == player.due - RUN_NS - MARGIN_NS
    assert player.rehearser.counts.spent_s == pytest.approx(KEPT * RUN_NS / NS_PER_S)
    assert replace(player.rehearser.counts, spent_s=0.0) == Rehearsals(rehearsed=KEPT)


def test_the_longest_of_the_last_ones_counts() -> None:
    player = playing()
    for run_ns in (RUN_NS, 3 * RUN_NS, *[RUN_NS] * (KEPT - 1)):
        player.run_ns = run_ns
        player.play()
    assert player.begin() == player.due - 3 * RUN_NS - MARGIN_NS
    player.play()
    assert player.begin() == player.due - RUN_NS - MARGIN_NS


def test_there_is_one_for_each_release() -> None:
    player = playing()
    player.rehearser.rehearse(lambda: False)
    assert player.begin() is None
    player.release()
    assert player.begin() is not None


def test_it_gives_way_to_a_release_that_comes_early() -> None:
    player = playing()
    player.gives_way = True
    player.play()
    assert player.rehearser.counts == Rehearsals(cut_short=1)


def test_a_task_that_is_busy_until_shortly_before_its_release_skips_it() -> None:
    player = playing()
    player.clock.advance((PERIOD_NS - FIRST_LEAD_NS // 2) / NS_PER_S)
    assert player.begin() is None
    assert player.begin() is None
    assert player.rehearser.counts.skipped == 1, "it is counted once"


def test_one_that_takes_a_large_share_of_the_period_is_none() -> None:
    player = playing(run_ns=PERIOD_NS // 3)
    player.play()
    assert player.begin() is None
    assert player.rehearser.counts.skipped == 1
