"""The compiled sending of a frame: to which rows, in which order, and with which result; and the reports of clients."""

import math
import random
import socket
from collections import Counter
from collections.abc import Iterator

import numpy as np
import pytest

from tests.protocol.samples import BOOT
from vision_core.clock import Instant, after
from vision_core.net import delivery as module
from vision_core.net.delivery import Batch, DeliveryTable
from vision_core.net.delivery_rows import (
    DROPPED,
    NEVER,
    NOT_SENT,
    REFUSED,
    SENT,
    UNKNOWN,
    mean_rank,
    new_rows,
    note_report,
)
from vision_core.protocol.messages import MAX_LAG_S, REPORT_PERIOD_S, LagReport
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.types.tables import Table

NOWHERE = -1
MS = 1_000_000


@pytest.fixture
def pairs() -> Iterator[list[tuple[socket.socket, socket.socket]]]:
    """Connected sockets: ours and a client's."""
    made = []
    for _ in range(5):
        client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        client.bind(("127.0.0.1", 0))
        client.settimeout(2.0)
        own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        own.setblocking(False)
        own.connect(client.getsockname())
        made.append((own, client))
    yield made
    for own, client in made:
        own.close()
        client.close()


def table_of(descriptors: list[int], options: Options = PAPER_OPTIONS, seed: int = 1) -> DeliveryTable:
    table = DeliveryTable(BOOT, seed)
    table.replace(new_rows(len(descriptors)))
    for row, descriptor in enumerate(descriptors):
        table.address(row, row, descriptor, options)
    return table


def test_each_row_gets_its_own_datagram(pairs: list[tuple[socket.socket, socket.socket]]) -> None:
    table = table_of([own.fileno() for own, _ in pairs])
    texts = [b"zero", b"", b"two" * 400, b"\0", b"(four)"]
    batch = Batch.of(texts)
    assert [bytes(batch.datagram(row)) for row in range(5)] == texts
    assert table.send(Instant(7), batch) == (4, 0)
    for row in (0, 2, 3, 4):
        assert pairs[row][1].recv(2000) == texts[row]
    rows = table.rows
    assert rows["result"].tolist() == [SENT, NOT_SENT, SENT, SENT, SENT]
    assert rows["grabbed_at"].tolist() == [7, NEVER, 7, 7, 7]
    assert sorted(rows["rank"][[0, 2, 3, 4]].tolist()) == [0, 1, 2, 3]
    in_order = rows[table.order[:4]]
    assert in_order["rank"].tolist() == [0, 1, 2, 3]
    assert (in_order["sent_at"][1:] >= in_order["sent_at"][:-1]).all()
    assert rows["sent"].tolist() == [1, 0, 1, 1, 1]


def test_a_closed_port_is_refused_and_a_broken_socket_drops(pairs: list[tuple[socket.socket, socket.socket]]) -> None:
    (gone, client), (well, _) = pairs[:2]
    client.close()
    table = table_of([gone.fileno(), well.fileno(), NOWHERE])
    batch = Batch.of([b"see"] * 3)
    table.send(Instant(1), batch)  # the report of the closed port comes with the next one
    assert table.send(Instant(2), batch) == (3, 1)
    assert table.rows["result"].tolist() == [REFUSED, SENT, DROPPED]
    assert table.rows["sent"].tolist() == [1, 2, 0]
    assert table.rows["dropped"].tolist() == [1, 0, 2]


def test_full_buffers_drop_and_do_not_wait() -> None:
    own, slow = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    with own, slow:
        table = table_of([own.fileno()])
        for frame in range(2000):
            table.send(Instant(frame), Batch.of([b"x" * 1000]))
        row = table.rows[0]
        assert row["dropped"] > 0
        assert row["sent"] > 0
        assert row["sent"] + row["dropped"] == row["frames"] == 2000


def test_every_order_is_as_likely_as_any_other() -> None:
    table = table_of([NOWHERE] * 4, seed=5)
    orders: Counter[tuple[int, ...]] = Counter()
    batch, frames = Batch.of([b"see"] * 4), 24_000
    for frame in range(frames):
        table.send(Instant(BOOT + frame * MS), batch)
        orders[tuple(table.order.tolist())] += 1
    assert len(orders) == 24
    expected = frames / 24
    chi_square = sum((count - expected) ** 2 / expected for count in orders.values())
    assert chi_square < 49.7  # 23 degrees of freedom: one in a thousand seeds
    assert [mean_rank(row) for row in table.rows] == pytest.approx([0.5] * 4, abs=0.02)


def test_two_servers_do_not_draw_the_same_orders() -> None:
    drawn = []
    for seed in (1, 2):
        table = table_of([NOWHERE] * 11, seed=seed)
        table.send(Instant(1), Batch.of([b"see"] * 11))
        drawn.append(table.order.tolist())
    assert drawn[0] != drawn[1]


def test_a_row_without_frames_has_a_fair_rank() -> None:
    assert mean_rank(new_rows(1)[0]) == 0.5


def test_an_empty_table_sends_nothing() -> None:
    table = DeliveryTable(BOOT)
    assert table.due(BOOT).tolist() == []
    assert table.send(BOOT, Batch.of([])) == (0, 0)


def test_one_signature_is_compiled() -> None:
    table = table_of([NOWHERE])
    table.send(Instant(1), Batch.of([b"see"]))
    table.due(Instant(2))
    for compiled in (vars(module)["send_all"], vars(module)["mark_due"]):
        assert len(compiled.signatures) == 1


def taken(options: Options, frames: list[Instant]) -> list[int]:
    """Times [ms] of the frames that a session is sent."""
    table, sent = table_of([NOWHERE], options), []
    for at in frames:
        if table.due(at)[0]:
            table.send(at, Batch.of([b"see"]))
            sent.append((at - BOOT) // MS)
    return sent


def frames(rate_hz: float, seconds: float, jitter_ms: float = 0.0) -> list[Instant]:
    period = 1e9 / rate_hz
    return [
        Instant(BOOT + round(i * period + (-1) ** i * jitter_ms * MS) + 10 * MS) for i in range(int(rate_hz * seconds))
    ]


def test_time_grows_as_printed() -> None:
    at = [Instant(BOOT + us * 1000) for us in (900, 1000, 1999, 2000, 1500, 3000)]
    assert taken(Options(), at) == [0, 1, 2, 3]
    assert len(taken(Options(time="us"), at)) == 5


@pytest.mark.parametrize("rate", [1, 7, 10, 15, 20, 29, 30, 31, 60])
@pytest.mark.parametrize("jitter_ms", [0.0, 3.0])
def test_a_rate_thins_out_evenly(rate: int, jitter_ms: float) -> None:
    seconds = 20
    sent = taken(Options(rate_hz=rate), frames(30.0, seconds, jitter_ms))
    expected = min(rate, 30) * seconds
    assert expected - seconds * 0.05 * rate - 1 <= len(sent) <= expected + 1
    for begin in range(0, (seconds - 1) * 1000, 50):
        assert sum(begin <= at < begin + 1000 for at in sent) <= rate + 1


def test_no_burst_after_a_pause() -> None:
    at = [Instant(BOOT + ms * MS) for ms in (0, 5000, 5033, 5067, 5100)]
    assert taken(Options(rate_hz=10), at) == [0, 5000, 5067]


SENT_AT = Instant(BOOT + 2_010 * MS)
"""When the view of 2.0005 s was sent."""


def reported(report: LagReport, options: Options = PAPER_OPTIONS) -> Table:
    """The row of a session that was sent a view and whose client reported 8 ms later."""
    table = table_of([NOWHERE], options)
    row: Table = table.rows[0]
    row["grabbed_at"], row["sent_at"] = BOOT + 2_000 * MS + MS // 2, SENT_AT
    note_report(row, report, BOOT, after(SENT_AT, 0.008))
    return row


def lags_of(row: Table) -> tuple[int, int]:
    """Lags of network and client [ns]."""
    return int(row["network_ns"]), int(row["client_ns"])


@pytest.mark.parametrize(("time", "time_us"), [("ms", 2_000_000), ("us", 2_000_500)])
def test_a_report_on_the_last_view_splits_the_lag(time: str, time_us: int) -> None:
    row = reported(LagReport(time_us, 0.002, 0.005), Options(time=time))
    assert lags_of(row) == (3 * MS, 5 * MS)
    assert row["reported_at"] == after(SENT_AT, 0.008)
    assert reported(LagReport(time_us + 1, 0.002, 0.005), Options(time=time))["reported_at"] == NEVER


def test_a_client_that_does_not_know_its_lag_has_none() -> None:
    row = reported(LagReport(2_000_000, 0.002, None))
    assert lags_of(row) == (3 * MS, UNKNOWN)


def test_a_view_held_for_longer_than_there_was_time_has_no_network_lag() -> None:
    assert reported(LagReport(2_000_000, 0.1, None))["network_ns"] == 0


@pytest.mark.parametrize("absurd_s", [-0.001, MAX_LAG_S + 0.001, math.inf, math.nan])
def test_impossible_reports_change_nothing(absurd_s: float) -> None:
    for report in (LagReport(2_000_000, absurd_s, 0.005), LagReport(2_000_000, 0.002, absurd_s)):
        row = reported(report)
        assert lags_of(row) == (UNKNOWN, UNKNOWN)
        assert row["reported_at"] == NEVER


def test_reports_that_come_fast_are_ignored() -> None:
    row = reported(LagReport(2_000_000, 0.0, 0.001))
    first_at = Instant(int(row["reported_at"]))
    note_report(row, LagReport(2_000_000, 0.0, 0.002), BOOT, after(first_at, 0.9 * REPORT_PERIOD_S))
    assert row["client_ns"] == MS
    note_report(row, LagReport(2_000_000, 0.0, 0.003), BOOT, after(first_at, REPORT_PERIOD_S))
    assert row["client_ns"] == 3 * MS


def test_before_the_first_view_there_is_nothing_to_report_on() -> None:
    row: Table = table_of([NOWHERE]).rows[0]
    note_report(row, LagReport(0, 0.0, 0.001), BOOT, after(BOOT, 1.0))
    assert row["reported_at"] == NEVER


def test_rows_keep_their_counters_when_others_come() -> None:
    table = table_of([NOWHERE])
    table.send(Instant(1), Batch.of([b"see"]))
    rows = new_rows(2)
    rows[1] = table.rows[0]
    table.replace(rows)
    table.send(Instant(2), Batch.of([b"see", b"see"]))
    assert table.rows["frames"].tolist() == [1, 2]
    assert np.array_equal(table.rows["grabbed_at"], [2, 2])


def test_a_seed_repeats_the_order() -> None:
    orders = []
    for seed in (7, 7, random.Random().getrandbits(32) + 8):
        table = table_of([NOWHERE] * 20, seed=seed)
        table.send(Instant(1), Batch.of([b"see"] * 20))
        orders.append(table.order.tolist())
    assert orders[0] == orders[1] != orders[2]
