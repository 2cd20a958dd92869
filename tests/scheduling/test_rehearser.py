"""When tasks rehearse: before each regular release, never twice, never without time, and they give way."""

from dataclasses import replace
from functools import partial

import pytest

from vision_core.clock import NS_PER_MS, NS_PER_S, Instant, ManualClock
from vision_core.rtdb.infos import Rehearsals
from vision_core.scheduling.rehearser import KEPT, MARGIN_NS, WATCH_NS, GiveWay, Part, Rehearser

PERIOD_NS = 33 * NS_PER_MS
COLD_NS, RUN_NS = 2 * NS_PER_MS, NS_PER_MS


class Player:
    """A task that is released with a period; a run takes COLD_NS, a rehearsal RUN_NS."""

    def __init__(self, parts: int = 1) -> None:
        self.clock = ManualClock(Instant(10**9))
        self.run_ns = RUN_NS
        self.released_after = 0
        """Parts of a rehearsal after which the task is released; 0: none."""
        self.rehearsed: list[int] = []
        self.rehearser = Rehearser(self.clock)
        self.parts = [Part(partial(self.rehearse, number)) for number in range(parts)]
        self.due = self.clock.now()

    def rehearse(self, number: int, give_way: GiveWay) -> bool:
        if give_way():
            return False
        self.rehearsed.append(number)
        self.clock.advance(self.run_ns / NS_PER_S)
        return True

    def release(self, times: int = 1, cold_ns: int = COLD_NS) -> None:
        for _ in range(times):
            self.clock.advance((self.due - self.clock.now()) / NS_PER_S)
            self.rehearser.released(self.clock.now())
            self.rehearser.ran(cold_ns)
            self.due = Instant(self.clock.now() + PERIOD_NS)

    def begin(self) -> Instant | None:
        return self.rehearser.begin(self.clock.now(), self.parts)

    def play(self) -> None:
        """Rehearse when it is time, then be released."""
        begin = self.begin()
        assert begin is not None
        self.clock.advance((begin - self.clock.now()) / NS_PER_S)
        self.rehearsed = []
        until = self.rehearser.rehearse(self.parts, lambda: 0 < self.released_after <= len(self.rehearsed))
        assert until == self.due + WATCH_NS
        self.release()

    @property
    def counts(self) -> Rehearsals:
        """Of the first part."""
        return self.parts[0].counts


def playing(parts: int = 1) -> Player:
    player = Player(parts)
    player.release(10)
    return player


def test_without_a_rhythm_there_is_none() -> None:
    player = Player()
    player.release(2)
    assert player.begin() is None
    assert player.counts.skipped == 0


def test_nothing_that_rehearses_is_no_rehearsal() -> None:
    player = playing()
    assert player.rehearser.begin(player.clock.now(), []) is None


def test_it_begins_so_early_that_it_ends_before_the_release() -> None:
    player = playing()
    assert player.begin() == player.due - COLD_NS - MARGIN_NS, "the lead is that of the runs so far"
    for _ in range(KEPT):
        player.play()
    assert player.begin() == player.due - RUN_NS - MARGIN_NS
    assert player.counts.spent_s == pytest.approx(KEPT * RUN_NS / NS_PER_S)
    assert replace(player.counts, spent_s=0.0) == Rehearsals(rehearsed=KEPT)


def test_a_run_after_a_rehearsal_is_not_cold() -> None:
    player = playing()
    for _ in range(KEPT):
        player.play()
    player.release(2, cold_ns=3 * RUN_NS)
    assert player.begin() == player.due - 3 * RUN_NS - MARGIN_NS


def test_one_long_run_does_not_count_two_do() -> None:
    player = playing()
    for run_ns, lead_ns in ((RUN_NS, RUN_NS), (3 * RUN_NS, RUN_NS), (4 * RUN_NS, 3 * RUN_NS), (RUN_NS, 3 * RUN_NS)):
        player.run_ns = run_ns
        for _ in range(KEPT if lead_ns == run_ns == RUN_NS else 1):
            player.play()
        assert player.begin() == player.due - lead_ns - MARGIN_NS


def test_there_is_one_for_each_release() -> None:
    player = playing()
    player.rehearser.rehearse(player.parts, lambda: False)
    assert player.begin() is None
    player.release()
    assert player.begin() is not None


def test_tasks_of_a_chain_rehearse_in_order() -> None:
    player = playing(parts=2)
    for _ in range(KEPT):
        player.play()
        assert player.rehearsed == [0, 1]
    assert player.begin() == player.due - 2 * RUN_NS - MARGIN_NS
    for part in player.parts:
        assert part.counts.spent_s == pytest.approx(KEPT * RUN_NS / NS_PER_S)


def test_they_give_way_to_a_release_that_comes_early() -> None:
    player = playing(parts=2)
    player.released_after = 1
    player.play()
    counts = [replace(part.counts, spent_s=0.0) for part in player.parts]
    assert counts == [Rehearsals(rehearsed=1), Rehearsals(cut_short=1)]


def test_a_task_that_is_busy_until_shortly_before_its_release_skips_it() -> None:
    player = playing()
    player.clock.advance((PERIOD_NS - COLD_NS // 2) / NS_PER_S)
    assert player.begin() is None
    assert player.begin() is None
    assert player.counts.skipped == 1, "it is counted once"


def test_one_that_takes_a_large_share_of_the_period_is_none() -> None:
    player = playing()
    player.release(KEPT, cold_ns=PERIOD_NS // 3)
    assert player.begin() is None
    assert player.counts.skipped == 1
    player.release(KEPT)
    assert player.begin() is not None
