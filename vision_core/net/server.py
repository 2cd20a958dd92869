"""Joins the server's sockets to ``Sessions``, without an event loop of its own.

One descriptor stands for all sockets: wait until ``fileno()`` is readable, then call ``handle_readable``,
which handles a bounded number of datagrams, so that a flood cannot hold up the frame. A frame's views are
made first and then sent back to back, in an order drawn anew for every frame (paper, section 3.3).

For that each session has a line in a table (``batch``): the next Time that it wants, and what it got. ``Session`` and
``Tally`` are brought up to date from it when somebody looks.
"""

import random
import select
import socket
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from vision_core.clock import NS_PER_S, Clock, Instant
from vision_core.geometry import Bytes
from vision_core.net.batch import DROPPED, REFUSED, SENT, Batch, Lines
from vision_core.net.udp import Datagram, Outcome, SessionSocket, SharedSocket
from vision_core.protocol.lifecycle import NS_PER_TICK, Peer, Port, Session
from vision_core.protocol.messages import Init
from vision_core.protocol.session import (
    Arrival,
    Event,
    Reply,
    SessionClosed,
    SessionMoved,
    SessionOpened,
    Sessions,
)

MAX_DATAGRAMS = 64
"""Handled in one go."""
MAX_OF_ONE = 16
"""Of one socket, before the others have their turn."""


@dataclass(frozen=True, slots=True)
class Delivery:
    """How one session was served in one frame."""

    session: Session
    rank: int
    """Place in the random order, 0 first."""
    sent: Instant
    outcome: Outcome


@dataclass(frozen=True, slots=True)
class Served:
    """How one frame was served, in short; ``UdpServer.deliveries`` has it at length."""

    sessions: int
    last: Instant | None
    """When the last of them was sent to."""
    events: tuple[Event, ...]
    """What the sending led to: sessions that ended or moved."""


@dataclass(slots=True)
class Tally:
    """What one session got, since this process serves it."""

    sent: int = 0
    dropped: int = 0
    frames: int = 0
    rank_sum: float = 0.0
    """Of places in the order, 0 first .. 1 last."""

    @property
    def mean_rank(self) -> float:
        """0.5 is fair."""
        return self.rank_sum / self.frames if self.frames else 0.5

    def count(self, outcome: Outcome, rank: int, clients: int) -> None:
        """One more frame, served to so many clients."""
        self.frames += 1
        self.rank_sum += rank / (clients - 1) if clients > 1 else 0.5
        if outcome is Outcome.SENT:
            self.sent += 1
        else:
            self.dropped += 1


@dataclass(slots=True)
class _Line:
    socket: SessionSocket
    tally: Tally
    init: Init
    nul: bool
    """As the table has it."""


TALLIED = ("sent", "dropped", "frames", "rank_sum")
"""Fields that a line and a Tally share."""
OUTCOMES = {SENT: Outcome.SENT, DROPPED: Outcome.DROPPED, REFUSED: Outcome.REFUSED}


class UdpServer:
    """Serves views to clients. Sessions that were restored get their sockets back at once."""

    def __init__(
        self,
        main: socket.socket,
        session: socket.socket,
        sessions: Sessions,
        clock: Clock,
        order: random.Random | None = None,
    ) -> None:
        self.sessions = sessions
        self._clock = clock
        self._order = order or random.Random()  # noqa: S311 (fairness, no secret); seeded by the system
        self._shared = {Port.MAIN: SharedSocket(main), Port.SESSION: SharedSocket(session)}
        self._lines: dict[Session, _Line] = {}
        self._table = Lines(sessions.rules.boot, self._order)
        self._in_table: tuple[Session, ...] = ()
        self._changed = True
        """The table does not have all sessions as they are."""
        self._sent_since = False
        """Sessions and tallies are behind the table."""
        self._listening: dict[int, SharedSocket | Session] = {}
        self._poll = select.epoll()
        for shared in self._shared.values():
            self._listen(shared.fileno(), shared)
        self._carry_out([SessionOpened(restored) for restored in sessions])

    def fileno(self) -> int:
        """Readable when any socket is: register the server itself with a selector."""
        return self._poll.fileno()

    def close(self) -> None:
        """Let go of the sessions' sockets. The two that were handed in stay open."""
        for line in self._lines.values():
            line.socket.close()
        self._lines.clear()
        self._listening.clear()
        self._poll.close()

    def tally(self, session: Session) -> Tally:
        """What an open session got. Raises KeyError when it is not open."""
        self._catch_up()
        return self._lines[session].tally

    def snapshot(self) -> bytes:
        """All sessions, for ``Sessions.restore`` in another process."""
        self._catch_up()
        return self.sessions.snapshot()

    def handle_readable(self) -> list[Event]:
        """Take what came in, at most 64 datagrams, and answer; returns what happened."""
        happened: list[Event] = []
        left = MAX_DATAGRAMS
        for descriptor, _ in self._poll.poll(0):
            source = self._listening.get(descriptor)
            for _ in range(min(left, MAX_OF_ONE)):
                if source is None or self._listening.get(descriptor) is not source:
                    break
                events = self._receive_from(source)
                if events is None:
                    break
                left -= 1
                happened += self._carry_out(events)
        return happened

    def expire(self) -> list[Event]:
        """End silent sessions; call it once a second or so."""
        return self._carry_out(self.sessions.expire(self._clock.now()))

    def due(self, at: Instant) -> tuple[tuple[Session, ...], Bytes]:
        """All sessions, and for each 1 when it wants a view grabbed at an instant, otherwise 0.

        The same tuple as last time, unless a session came, went, moved or changed its wishes.
        """
        if self._changed:
            self._fill_table()
        return self._in_table, self._table.due(at)

    def send_batch(self, at: Instant, batch: Batch) -> Served:
        """Send a frame's views, made for the sessions of ``due``, in random order.

        at: grab of the frame; a datagram of length 0 is not sent. Raises ValueError when the batch is for others,
        or sessions have changed since ``due``.
        """
        if self._changed or len(batch.lengths) != len(self._in_table):
            found = "they have changed" if self._changed else f"{len(self._in_table)}"
            raise ValueError(f"{len(batch.lengths)} datagrams for the sessions of due(): {found}")
        count, refusals = self._table.send(at, batch)
        self._sent_since = True
        rows, order = self._table.rows, self._table.order
        events: list[Event] = []
        for row in order[:count] if refusals else ():
            if rows[row]["outcome"] == REFUSED and (session := self._in_table[row]) in self._lines:
                events += self._carry_out(self.sessions.refused(session, Instant(int(rows[row]["sent_at"]))))
        last = Instant(int(rows[order[count - 1]]["sent_at"])) if count else None
        return Served(count, last, tuple(events))

    def deliveries(self) -> list[Delivery]:
        """How each session was served in the last batch, in the order of sending."""
        rows = self._table.rows
        served = sorted(np.flatnonzero(rows["outcome"]).tolist(), key=lambda row: int(rows[row]["rank"]))
        return [
            Delivery(
                self._in_table[row],
                int(rows[row]["rank"]),
                Instant(int(rows[row]["sent_at"])),
                OUTCOMES[int(rows[row]["outcome"])],
            )
            for row in served
        ]

    def _receive_from(self, source: SharedSocket | Session) -> list[Event] | None:
        """What the next datagram of a socket leads to; None when there is none."""
        now = self._clock.now()
        self._catch_up()  # a client may report on the view that it was just sent
        if isinstance(source, Session):
            received = self._lines[source].socket.receive()
            port = source.port
        else:
            received = source.receive()
            port = Port.MAIN if source is self._shared[Port.MAIN] else Port.SESSION
        if isinstance(received, Datagram):
            return self.sessions.receive(received.data, Peer(*received.peer), Arrival(port, received.local), now)
        if received is None or not isinstance(source, Session):
            return None
        return self.sessions.refused(source, now)

    def _carry_out(self, events: Iterable[Event]) -> list[Event]:
        """Open, move and close sockets and send replies, in order; returns all events."""
        happened: list[Event] = []
        waiting = deque(events)
        while waiting:
            event = waiting.popleft()
            happened.append(event)
            match event:
                case SessionOpened(session) | SessionMoved(session):
                    if not self._open(session):
                        waiting.extend(self.sessions.not_opened(session))
                case SessionClosed(session):
                    self._close(session)
                case Reply():
                    waiting.extend(self._reply(event))
        return happened

    def _reply(self, reply: Reply) -> list[Event]:
        if reply.session is None:
            self._shared[reply.via.port].send(reply.data, reply.to, reply.via.local)
            return []
        line = self._lines.get(reply.session)
        if line is not None and (line.init != reply.session.init or line.nul != reply.session.nul):
            self._changed = True
        if line is None or line.socket.send(reply.data) is not Outcome.REFUSED:
            return []
        return self.sessions.refused(reply.session, self._clock.now())

    def _open(self, session: Session) -> bool:
        """A socket for a session; its tally goes on when it moves."""
        tally = self._lines[session].tally if session in self._lines else Tally()
        self._close(session)
        try:
            opened = SessionSocket(self._shared[session.port].socket, session.local, session.peer)
        except OSError:
            return False
        self._lines[session] = _Line(opened, tally, session.init, session.nul)
        self._listen(opened.fileno(), session)
        return True

    def _close(self, session: Session) -> None:
        self._catch_up()
        self._changed = True
        line = self._lines.pop(session, None)
        if line is not None:
            del self._listening[line.socket.fileno()]
            line.socket.close()

    def _fill_table(self) -> None:
        """Give every session a line, with what it wants and what it got so far."""
        self._catch_up()
        rows = self._table.resize(len(self._lines))
        self._in_table = tuple(self._lines)
        self._changed = False
        for row, (session, line) in enumerate(self._lines.items()):
            line.init, line.nul = session.init, session.nul
            options, tally = session.init.options, line.tally
            rows[row]["descriptor"], rows[row]["tick_ns"] = line.socket.fileno(), NS_PER_TICK[options.time]
            rows[row]["period_ns"] = NS_PER_S // options.rate_hz if options.rate_hz else 0
            rows[row]["served"], rows[row]["due"] = session.served, session.due
            rows[row]["sent_at"] = session.served_at
            for name in TALLIED:
                rows[row][name] = getattr(tally, name)

    def _catch_up(self) -> None:
        """Bring sessions and tallies up to date with the table."""
        if not self._sent_since:
            return
        self._sent_since = False
        for session, row in zip(self._in_table, self._table.rows, strict=True):
            session.served, session.due = Instant(int(row["served"])), Instant(int(row["due"]))
            session.served_at = Instant(int(row["sent_at"]))
            line = self._lines.get(session)
            if line is not None:
                for name in TALLIED:
                    setattr(line.tally, name, row[name].item())

    def _listen(self, descriptor: int, source: SharedSocket | Session) -> None:
        self._listening[descriptor] = source
        self._poll.register(descriptor, select.EPOLLIN)
