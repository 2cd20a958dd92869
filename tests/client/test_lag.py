"""Reports of the lag: what is measured, when it is said, and what the system tells of an arrival."""

import math
import socket
import time
from collections.abc import Iterator

import pytest

from vision_core.arrival_stamps import stamp_arrivals
from vision_core.client.clock_sync import ServerTime
from vision_core.client.lag import REPORT_S, Lag, LagReports, lag_of, receive_stamped
from vision_core.clock import Instant, after
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import MAX_LAG_S, LagReport

START = Instant(1_000_000_000)
DUE = after(START, REPORT_S)
TIME_US = 20306_148000
PAUSE_S = 0.02


def using(*uses_s: float) -> LagReports:
    """Reports of a program that took so long for each of its views so far; the next view makes one due."""
    reports = LagReports(START)
    for use_s in uses_s:
        assert reports.view_arrived(1, START, START) is None
        reports.view_used(after(START, use_s))
    return reports


def test_a_report_tells_the_hold_and_the_median_use() -> None:
    reports = using(0.004, 0.9, 0.006)
    assert reports.view_arrived(TIME_US, DUE, after(DUE, 0.002)) == LagReport(TIME_US, 0.002, 0.006)


def test_the_parts_of_a_lag() -> None:
    known, unknown = ServerTime(20.0100, 0.0002), ServerTime(math.nan, math.inf)
    lag = lag_of(20.0, 0.007, known, 0.004)
    assert lag is not None
    assert lag.network_s == pytest.approx(0.003)
    assert (lag.server_s, lag.client_s, lag.bound_s) == (0.007, 0.004, 0.0002)
    assert lag.total_s == pytest.approx(0.014)
    assert lag_of(20.0, None, known, 0.004) is None
    assert lag_of(20.0, 0.007, unknown, 0.004) is None


def test_the_last_lag_is_that_of_the_view_that_was_used() -> None:
    reports, lag = LagReports(START), Lag(0.007, 0.003, 0.0, 0.0002)
    reports.view_arrived(1, START, START)
    reports.view_given(lag)
    assert reports.last is None
    reports.view_used(after(START, 0.005))
    assert reports.last == Lag(0.007, 0.003, 0.005, 0.0002)
    reports.view_arrived(2, START, START)
    reports.view_given(None)
    reports.view_used(after(START, 0.009))
    assert reports.last is None


def test_each_report_has_a_median_of_its_own() -> None:
    reports = using(0.004)
    assert reports.view_arrived(TIME_US, DUE, DUE) == LagReport(TIME_US, 0.0, 0.004)
    again = after(DUE, REPORT_S)
    assert reports.view_arrived(TIME_US, again, after(again, -0.1)) is None
    assert reports.view_arrived(TIME_US, again, again) == LagReport(TIME_US, 0.0, None)


def test_asking_again_without_a_new_view_is_no_use() -> None:
    reports = using(0.004)
    reports.view_used(after(START, 0.8))
    assert reports.view_arrived(TIME_US, DUE, DUE) == LagReport(TIME_US, 0.0, 0.004)


def test_what_the_server_would_pass_over_is_not_sent() -> None:
    reports = using(2.0 * MAX_LAG_S)
    assert reports.view_arrived(TIME_US, START, after(DUE, MAX_LAG_S)) is None
    assert reports.view_arrived(TIME_US, DUE, DUE) == LagReport(TIME_US, 0.0, None)


def test_errors_are_explained_by_a_report_that_was_sent() -> None:
    reports = LagReports(START)
    assert not reports.explains(ErrorCode.NOT_CONNECTED)
    assert reports.view_arrived(TIME_US, DUE, DUE) is not None
    assert reports.explains(ErrorCode.NOT_CONNECTED)
    assert not reports.explains(ErrorCode.REPLACED)
    assert reports.view_arrived(TIME_US, DUE, after(DUE, REPORT_S)) is not None
    assert reports.explains(ErrorCode.UNKNOWN_COMMAND)
    assert reports.view_arrived(TIME_US, DUE, after(DUE, 2.0 * REPORT_S)) is None


@pytest.fixture
def mailbox() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as opened:
        opened.bind(("127.0.0.1", 0))
        yield opened


def age_after_pause(mailbox: socket.socket) -> float:
    """Age [s] of a datagram that is read a pause after it was sent."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.sendto(b"see", mailbox.getsockname())
        time.sleep(PAUSE_S)
        data, source, age_ns = receive_stamped(mailbox, 100)
        assert data == b"see"
        assert source[1] == sender.getsockname()[1]
    return age_ns / 1e9


def test_the_wait_for_a_busy_program_is_seen(mailbox: socket.socket) -> None:
    stamp_arrivals(mailbox)
    ages_s = [age_after_pause(mailbox) for _ in range(10)]  # the system may take a moment to begin
    assert ages_s[-1] >= PAUSE_S


def test_without_stamps_a_view_arrives_when_it_is_read(mailbox: socket.socket, monkeypatch: pytest.MonkeyPatch) -> None:
    assert age_after_pause(mailbox) == 0.0
    monkeypatch.setattr("sys.platform", "darwin")
    stamp_arrivals(mailbox)
    assert age_after_pause(mailbox) == 0.0


@pytest.mark.parametrize("now_ns", [0, 2**62])
def test_a_time_of_day_that_steps_is_no_age(
    mailbox: socket.socket, monkeypatch: pytest.MonkeyPatch, now_ns: int
) -> None:
    stamp_arrivals(mailbox)
    monkeypatch.setattr("vision_core.arrival_stamps.time.time_ns", lambda: now_ns)
    assert age_after_pause(mailbox) == 0.0
