"""The compiled sending of a frame: whom, in which order, and what became of it."""

import random
import socket
from collections import Counter
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tests.protocol.samples import BOOT, CLIENT
from vision_core.clock import Instant
from vision_core.net import batch as module
from vision_core.net.batch import DROPPED, NOT_SENT, REFUSED, SENT, Batch, Lines
from vision_core.protocol.lifecycle import NS_PER_TICK, Session, State
from vision_core.protocol.messages import Init
from vision_core.protocol.options import Options
from vision_core.types.objects import Team

NOWHERE = -1


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


def lines_to(descriptors: list[int], seed: int = 1) -> Lines:
    lines = Lines(BOOT, random.Random(seed))
    rows = lines.resize(len(descriptors))
    rows["descriptor"], rows["tick_ns"], rows["served"], rows["due"] = descriptors, 1_000_000, -1, -1
    return lines


def test_each_line_gets_its_own_datagram(pairs: list[tuple[socket.socket, socket.socket]]) -> None:
    lines = lines_to([own.fileno() for own, _ in pairs])
    texts = [b"zero", b"", b"two" * 400, b"\0", b"(four)"]
    batch = Batch.of(texts)
    assert [bytes(batch.datagram(row)) for row in range(5)] == texts
    assert lines.send(Instant(7), batch) == (4, 0)
    for row in (0, 2, 3, 4):
        assert pairs[row][1].recv(2000) == texts[row]
    rows = lines.rows
    assert rows["outcome"].tolist() == [SENT, NOT_SENT, SENT, SENT, SENT]
    assert rows["served"].tolist() == [7, -1, 7, 7, 7]
    assert sorted(rows["rank"][[0, 2, 3, 4]].tolist()) == [0, 1, 2, 3]
    in_order = rows[lines.order[:4]]
    assert in_order["rank"].tolist() == [0, 1, 2, 3]
    assert (in_order["sent_at"][1:] >= in_order["sent_at"][:-1]).all()
    assert rows["sent"].tolist() == [1, 0, 1, 1, 1]


def test_a_closed_port_is_refused_and_a_broken_socket_drops(pairs: list[tuple[socket.socket, socket.socket]]) -> None:
    (gone, client), (well, _) = pairs[:2]
    client.close()
    lines = lines_to([gone.fileno(), well.fileno(), NOWHERE])
    batch = Batch.of([b"see"] * 3)
    lines.send(Instant(1), batch)  # the answer to this one comes with the next
    assert lines.send(Instant(2), batch) == (3, 1)
    assert lines.rows["outcome"].tolist() == [REFUSED, SENT, DROPPED]
    assert lines.rows["sent"].tolist() == [1, 2, 0]
    assert lines.rows["dropped"].tolist() == [1, 0, 2]


def test_full_buffers_drop_and_do_not_wait() -> None:
    own, slow = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    with own, slow:
        lines = lines_to([own.fileno()])
        for frame in range(2000):
            lines.send(Instant(frame), Batch.of([b"x" * 1000]))
        row = lines.rows[0]
        assert row["dropped"] > 0
        assert row["sent"] > 0
        assert row["sent"] + row["dropped"] == row["frames"] == 2000


def test_every_order_is_as_likely_as_any_other() -> None:
    lines = lines_to([NOWHERE] * 4, seed=5)
    orders: Counter[tuple[int, ...]] = Counter()
    batch, frames = Batch.of([b"see"] * 4), 24_000
    for frame in range(frames):
        lines.send(Instant(frame), batch)
        orders[tuple(lines.order.tolist())] += 1
    assert len(orders) == 24
    expected = frames / 24
    chi_square = sum((count - expected) ** 2 / expected for count in orders.values())
    assert chi_square < 49.7  # 23 degrees of freedom: one in a thousand seeds
    means = lines.rows["rank_sum"] / lines.rows["frames"]
    assert means.tolist() == pytest.approx([0.5] * 4, abs=0.02)


def test_two_servers_do_not_draw_the_same_orders() -> None:
    drawn = []
    for seed in (1, 2):
        lines = lines_to([NOWHERE] * 11, seed)
        lines.send(Instant(1), Batch.of([b"see"] * 11))
        drawn.append(lines.order.tolist())
    assert drawn[0] != drawn[1]


@given(
    time=st.sampled_from(["ms", "us"]),
    rate_hz=st.none() | st.integers(1, 1000),
    steps=st.lists(st.integers(0, 60_000_000), max_size=60),
    start=st.integers(0, 10**12),
)
@hypothesis_settings(max_examples=200, deadline=None)
def test_a_line_wants_what_its_session_wants(time: str, rate_hz: int | None, steps: list[int], start: int) -> None:
    init = Init(Team.BLUE, 3, Options(time=time, rate_hz=rate_hz))
    session = Session(init, False, CLIENT, "", BOOT, BOOT, State.SETTLED, BOOT, BOOT)
    lines = lines_to([NOWHERE])
    lines.rows["tick_ns"] = NS_PER_TICK[time]
    lines.rows["period_ns"] = 10**9 // rate_hz if rate_hz else 0
    at = Instant(BOOT + start)
    for step in steps:
        at = Instant(at + step)
        wanted = session.wants(at)
        assert lines.due(at).tolist() == [wanted]
        if wanted:
            session.note_served(at)
            lines.send(at, Batch.of([b"see"]))
        assert (lines.rows[0]["served"], lines.rows[0]["due"]) == (session.served, session.due)


def test_nobody_is_no_trouble() -> None:
    lines = Lines(BOOT, random.Random(1))
    assert lines.due(BOOT).tolist() == []
    assert lines.send(BOOT, Batch.of([])) == (0, 0)


def test_one_signature_is_compiled() -> None:
    lines = lines_to([NOWHERE])
    lines.send(Instant(1), Batch.of([b"see"]))
    lines.due(Instant(2))
    for compiled in (vars(module)["send_all"], vars(module)["mark_due"]):
        assert len(compiled.signatures) == 1
