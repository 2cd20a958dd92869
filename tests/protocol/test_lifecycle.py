"""One session: which views it wants, and its states."""

import math

import pytest

from tests.protocol.samples import BOOT, CLIENT
from vision_core.clock import Instant, after
from vision_core.protocol.lifecycle import NEVER, REPORT_PERIOD_S, TRANSITIONS, Change, Session, State
from vision_core.protocol.messages import MAX_LAG_S, Init, Lag
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.types.objects import Team

MS = 1_000_000


def session(options: Options, state: State = State.TRYING) -> Session:
    return Session(Init(Team.BLUE, 3, options), False, CLIENT, "127.0.0.1", BOOT, BOOT, state, BOOT, BOOT)


def served(options: Options, frames: list[Instant]) -> list[int]:
    """Times [ms] of the frames that a session takes."""
    one = session(options)
    taken = []
    for at in frames:
        if one.wants(at):
            one.note_served(at)
            taken.append((at - BOOT) // MS)
    return taken


def frames(rate_hz: float, seconds: float, jitter_ms: float = 0.0) -> list[Instant]:
    period = 1e9 / rate_hz
    return [
        Instant(BOOT + round(i * period + (-1) ** i * jitter_ms * MS) + 10 * MS) for i in range(int(rate_hz * seconds))
    ]


def test_time_grows_as_printed() -> None:
    at = [Instant(BOOT + us * 1000) for us in (900, 1000, 1999, 2000, 1500, 3000)]
    assert served(Options(), at) == [0, 1, 2, 3]
    assert len(served(Options(time="us"), at)) == 5


@pytest.mark.parametrize("rate", [1, 7, 10, 15, 20, 29, 30, 31, 60])
@pytest.mark.parametrize("jitter_ms", [0.0, 3.0])
def test_a_rate_thins_out_evenly(rate: int, jitter_ms: float) -> None:
    seconds = 20
    taken = served(Options(rate_hz=rate), frames(30.0, seconds, jitter_ms))
    expected = min(rate, 30) * seconds
    assert expected - seconds * 0.05 * rate - 1 <= len(taken) <= expected + 1
    for begin in range(0, (seconds - 1) * 1000, 50):
        assert sum(begin <= at < begin + 1000 for at in taken) <= rate + 1


def test_no_burst_after_a_pause() -> None:
    at = [Instant(BOOT + ms * MS) for ms in (0, 5000, 5033, 5067, 5100)]
    assert served(Options(rate_hz=10), at) == [0, 5000, 5067]


SENT = Instant(BOOT + 2_010 * MS)
"""When the view of 2.0005 s was sent."""


def reported(lag: Lag, options: Options = PAPER_OPTIONS) -> Session:
    """A session that was sent a view, and 8 ms later heard a report."""
    one = session(options)
    one.note_served(Instant(BOOT + 2_000 * MS + MS // 2))
    one.served_at = SENT
    one.note_report(lag, after(SENT, 0.008))
    return one


@pytest.mark.parametrize(("time", "time_us"), [("ms", 2_000_000), ("us", 2_000_500)])
def test_a_report_on_the_last_view_splits_the_lag(time: str, time_us: int) -> None:
    one = reported(Lag(time_us, 0.002, 0.005), Options(time=time))
    assert one.network_s == pytest.approx(0.003)
    assert (one.client_s, one.reported) == (0.005, after(SENT, 0.008))
    assert reported(Lag(time_us + 1, 0.002, 0.005), Options(time=time)).network_s is None


def test_what_a_client_does_not_know_is_not_known() -> None:
    one = reported(Lag(2_000_000, 0.002, None))
    assert one.network_s == pytest.approx(0.003)
    assert one.client_s is None


def test_who_claims_to_have_held_it_for_longer_than_there_was_time_has_no_network_lag() -> None:
    assert reported(Lag(2_000_000, 0.1, None)).network_s == 0.0


@pytest.mark.parametrize("absurd_s", [-0.001, MAX_LAG_S + 0.001, math.inf, math.nan])
def test_absurd_reports_change_nothing(absurd_s: float) -> None:
    for lag in (Lag(2_000_000, absurd_s, 0.005), Lag(2_000_000, 0.002, absurd_s)):
        one = reported(lag)
        assert (one.network_s, one.client_s, one.reported) == (None, None, NEVER)


def test_reports_are_taken_now_and_then() -> None:
    one = reported(Lag(2_000_000, 0.0, 0.001))
    one.note_report(Lag(2_000_000, 0.0, 0.002), after(one.reported, 0.9 * REPORT_PERIOD_S))
    assert one.client_s == 0.001
    one.note_report(Lag(2_000_000, 0.0, 0.003), after(one.reported, REPORT_PERIOD_S))
    assert one.client_s == 0.003


def test_before_the_first_view_and_after_a_restart_there_is_nothing_to_report_on() -> None:
    fresh = session(Options())
    fresh.note_report(Lag(0, 0.0, 0.001), after(BOOT, 1.0))
    one = reported(Lag(2_000_000, 0.0, 0.001))
    restarted = Session.from_plain(one.to_plain(), BOOT)
    restarted.note_report(Lag(2_000_000, 0.0, 0.001), after(SENT, 1.0))
    assert (fresh.reported, restarted.reported) == (NEVER, NEVER)


def test_everything_that_is_open_can_be_closed_and_nothing_comes_back() -> None:
    ends = {Change.REFUSED, Change.LEFT, Change.SILENT, Change.REPLACED, Change.STOPPED}
    for state in State:
        for change in Change:
            after = TRANSITIONS.get((state, change), state)
            if state is State.CLOSED or change in ends:
                assert after is State.CLOSED


def test_it_survives_as_plain_data() -> None:
    one = session(Options(types="team", rate_hz=10, fov_deg=90.0, center_deg=0.25), State.SETTLED)
    one.note_served(Instant(BOOT + 5 * MS))
    copy = Session.from_plain(one.to_plain(), BOOT)
    assert copy.to_plain() == one.to_plain()
    assert copy.init == one.init
    assert not copy.wants(Instant(BOOT + 50 * MS))
    assert copy.wants(Instant(BOOT + 110 * MS))
