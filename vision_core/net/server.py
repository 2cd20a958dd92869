"""Joins the server's sockets to ``Sessions``, without an event loop of its own.

One descriptor stands for all sockets: wait until ``fileno()`` is readable, then call ``handle_readable``, which handles
a bounded number of datagrams, so that a flood cannot delay the next frame. The sockets of sessions, which receive from
their clients only, come first. The two shared sockets, where anybody may send, have a budget of time per frame; when it
is used up, they are not listened to until the next frame was sent, and the kernel drops what their buffers cannot hold.
All views of a frame are made first and then
sent back to back, in a new random order for every frame (paper, section 3.3).

Each session has a row in the ``DeliveryTable``: when it is due, and what it was sent. Rows are added and removed before
the first use after a session was opened, moved, changed or closed. They are in the order of ``robot_index``: so the
order of sending follows from the seed, the frame and the robots alone.
"""

import select
import socket
import time
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from vision_core.clock import NS_PER_S, Clock, Instant
from vision_core.geometry import Bytes
from vision_core.net.delivery import Batch, DeliveryTable
from vision_core.net.delivery_rows import DELIVERY, REFUSED, UNREACHABLE, new_rows, note_report
from vision_core.net.fairness import FairnessRecord
from vision_core.net.udp import Datagram, SendResult, SessionSocket, SharedSocket, open_sink
from vision_core.protocol.encoding import encode
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import (
    Endpoint,
    Event,
    LagReported,
    Reply,
    SessionChanged,
    SessionClosed,
    SessionMoved,
    SessionOpened,
    SyncAsked,
)
from vision_core.protocol.lifecycle import Peer, Port, Session
from vision_core.protocol.messages import SyncReply
from vision_core.protocol.rules import SessionRules
from vision_core.protocol.session import Sessions
from vision_core.types.fairness import robot_index
from vision_core.types.objects import Team
from vision_core.types.tables import Table

MAX_DATAGRAMS = 64
"""Handled by one call of ``handle_readable``."""
MAX_PER_SOCKET = 16
"""Handled of one socket before the next socket has its turn."""
STRANGERS_S = 1e-3
"""Processor time for datagrams of the shared sockets, between two frames."""


@dataclass(frozen=True, slots=True)
class SendSummary:
    """How one frame was sent."""

    sessions: int
    """Sessions that had a datagram."""
    last: Instant | None
    """When the last datagram was sent."""
    events: tuple[Event, ...]
    """Sessions that ended or moved because their client refused the datagram."""


class UdpServer:
    """Sends views to clients and answers them."""

    def __init__(
        self,
        main: socket.socket,
        session: socket.socket,
        sessions: Sessions,
        clock: Clock,
        seed: int | None = None,
        strangers_s: float = STRANGERS_S,
    ) -> None:
        """main, session: bound, non-blocking sockets of the two ports; they stay open when the server is closed.

        sessions: may hold sessions of an earlier process; their sockets are opened at once. seed: of the order of
        sending. strangers_s: processor time for the shared sockets between two frames.
        """
        self.sessions = sessions
        self._clock = clock
        self._shared = {Port.MAIN: SharedSocket(main), Port.SESSION: SharedSocket(session)}
        self._sockets: dict[Session, SessionSocket] = {}
        self._table = DeliveryTable(sessions.rules.boot, seed)
        self._in_table: tuple[Session, ...] = ()
        """The session of each row."""
        self._table_is_stale = True
        self._sources: dict[int, SharedSocket | Session] = {}
        """What each descriptor of the poll set belongs to."""
        self._budget_ns = round(strangers_s * NS_PER_S)
        self._strangers_ns = 0
        """Processor time that the shared sockets have taken since the last frame."""
        self._sink = open_sink()
        self._poll = select.epoll()
        for shared in self._shared.values():
            self._listen(shared.fileno(), shared)
        self.apply_events([SessionOpened(restored) for restored in sessions])

    @staticmethod
    def restore(
        main: socket.socket,
        session: socket.socket,
        rules: SessionRules,
        snapshot: bytes,
        clock: Clock,
        seed: int | None = None,
    ) -> "UdpServer":
        """Go on where the process stopped that made a snapshot. Raises ValueError unless it is one of this boot."""
        text, _, rows = snapshot.partition(b"\n")
        sessions = Sessions.restore(rules, text)
        restored = tuple(sessions)
        if len(rows) != len(restored) * DELIVERY.itemsize:
            raise ValueError(f"a snapshot of {len(restored)} sessions with {len(rows)} bytes of deliveries")
        server = UdpServer(main, session, sessions, clock, seed)
        server._table.replace(np.frombuffer(rows, dtype=DELIVERY).copy())
        server._in_table = restored
        server._table_is_stale = True
        return server

    def snapshot(self) -> bytes:
        """All sessions and their rows, for ``restore`` in another process: a line of JSON, and the rows' memory."""
        self._update_table()
        rows = [self._in_table.index(session) for session in self.sessions]
        return self.sessions.snapshot() + b"\n" + self._table.rows[rows].tobytes()

    @property
    def fairness(self) -> FairnessRecord:
        """How every robot was served since the match began."""
        return self._table.fairness

    def fileno(self) -> int:
        """Readable when any socket is: register the server itself with a selector."""
        return self._poll.fileno()

    def close(self) -> None:
        """Close the sockets of all sessions."""
        for session_socket in self._sockets.values():
            session_socket.close()
        self._sockets.clear()
        self._sources.clear()
        self._sink.close()
        self._poll.close()

    def __contains__(self, session: Session) -> bool:
        """Is the session open?"""
        return session in self._sockets

    def delivery(self, session: Session) -> Table:
        """The row of an open session, one DELIVERY. Raises KeyError when the session is not open."""
        if session not in self._sockets:
            raise KeyError(session)
        self._update_table()
        row: Table = self._table.rows[self._in_table.index(session)]
        return row

    @property
    def dropped_by_kernel(self) -> int:
        """Datagrams to the shared sockets that never reached us: no commands, or a full buffer."""
        return sum(shared.dropped for shared in self._shared.values())

    def handle_readable(self) -> list[Event]:
        """Receive at most 64 datagrams and answer them; returns what happened."""
        happened: list[Event] = []
        left = MAX_DATAGRAMS
        ready = [(self._sources.get(descriptor), descriptor) for descriptor, _ in self._poll.poll(0)]
        ready.sort(key=lambda one: isinstance(one[0], SharedSocket))  # clients before strangers
        for source, descriptor in ready:
            for _ in range(min(left, MAX_PER_SOCKET)):
                if source is None or self._sources.get(descriptor) is not source or not self._hears(source):
                    break
                events = self._receive_from(source)
                if events is None:
                    break
                left -= 1
                happened += self.apply_events(events)
        return happened

    def _hears(self, source: SharedSocket | Session) -> bool:
        """Is a source to be read now? The shared sockets have a budget."""
        return isinstance(source, Session) or self._strangers_ns < self._budget_ns

    def _charge_strangers(self, spent_ns: int) -> None:
        """Take processor time from the shared sockets' budget. Used up: they wake nobody until the next frame."""
        before, self._strangers_ns = self._strangers_ns, self._strangers_ns + spent_ns
        if before < self._budget_ns <= self._strangers_ns:
            self._wake_for_strangers(0)

    def _listen_to_strangers(self) -> None:
        """Give the shared sockets a new budget."""
        if self._strangers_ns >= self._budget_ns:
            self._wake_for_strangers(select.EPOLLIN)
        self._strangers_ns = 0

    def _wake_for_strangers(self, events: int) -> None:
        for shared in self._shared.values():
            self._poll.modify(shared.fileno(), events)

    def expire(self) -> list[Event]:
        """End silent sessions; to be called once a second or so."""
        self._listen_to_strangers()  # also when no frames come
        return self.apply_events(self.sessions.expire(self._clock.now()))

    def apply(self, rules: SessionRules, mode: str, at: Instant) -> list[Event]:
        """Go on with other rules; returns what follows: sessions that they do not allow end.

        at: grab of the first frame that is served by them; clients are told it.
        """
        events = self.apply_events(self.sessions.apply(rules, mode, at))
        self._table_is_stale = True  # the encoder reads the clients' options anew
        for session, session_socket in self._sockets.items():
            session_socket.stay_local(rules.is_guest(session))
        return events

    def end(self, team: Team, number: int, since: Instant) -> list[Event]:
        """End a robot's session if it was opened at an instant, and tell its client."""
        for session in self.sessions:
            if (session.team, session.number, session.opened) == (team, number, since):
                return self.apply_events(self.sessions.end(session, ErrorCode.NOT_CONNECTED, self._clock.now()))
        return []

    def due(self, at: Instant) -> tuple[tuple[Session, ...], Bytes]:
        """All sessions, and for each 1 if it is to get a view grabbed at an instant, else 0.

        The tuple of sessions is the same object as last time, unless a session came, went, moved or changed.
        """
        self._update_table()
        return self._in_table, self._table.due(at)

    def send_batch(self, at: Instant, batch: Batch) -> SendSummary:
        """Send a frame's views, made for the sessions of ``due``, in random order.

        at: grab of the frame; a datagram of length 0 is not sent. Raises ValueError when the batch is of another
        length, or sessions have changed since ``due``.
        """
        if self._table_is_stale or len(batch.lengths) != len(self._in_table):
            found = "they have changed" if self._table_is_stale else f"{len(self._in_table)}"
            raise ValueError(f"{len(batch.lengths)} datagrams for the sessions of due(): {found}")
        count, refusals = self._table.send(at, batch)
        rows, order = self._table.rows, self._table.order
        events: list[Event] = []
        for row in order[:count] if refusals else ():
            session, sent_at = self._in_table[row], Instant(int(rows[row]["sent_at"]))
            if rows[row]["result"] == UNREACHABLE:
                session.unreachable = sent_at
            elif rows[row]["result"] == REFUSED and session in self._sockets:
                events += self.apply_events(self.sessions.refused(session, sent_at))
        self._listen_to_strangers()
        last = Instant(int(rows[order[count - 1]]["sent_at"])) if count else None
        return SendSummary(count, last, tuple(events))

    def show(self, datagram: bytes) -> None:
        """Send the field to every monitor."""
        for monitor in self.sessions.monitors:
            ended = datagram + (b"\0" if monitor.nul else b"")
            self._shared[monitor.endpoint.port].send(ended, monitor.peer, monitor.endpoint.local)

    def rehearse_batch(self, at: Instant, batch: Batch) -> None:
        """Send a frame's views to a socket of our own that drops them; nothing changes."""
        if not self._table_is_stale and len(batch.lengths) == len(self._in_table):
            self._table.rehearse(at, batch, self._sink.fileno())

    def apply_events(self, events: Iterable[Event]) -> list[Event]:
        """Open, move and close sockets and send replies, in order; returns these events and those that followed."""
        happened: list[Event] = []
        waiting = deque(events)
        while waiting:
            event = waiting.popleft()
            happened.append(event)
            match event:
                case SessionOpened(session) | SessionMoved(session):
                    if not self._open(session):
                        waiting.extend(self.sessions.not_opened(session, self._clock.now()))
                case SessionChanged():
                    self._table_is_stale = True
                case SessionClosed(session):
                    self._close(session)
                case LagReported(session, report, at):
                    note_report(self.delivery(session), report, self.sessions.rules.boot, at)
                case SyncAsked():
                    waiting.extend(self._answer_sync(event))
                case Reply():
                    waiting.extend(self._send_reply(event))
        return happened

    def _receive_from(self, source: SharedSocket | Session) -> list[Event] | None:
        """The events that follow from the next datagram of a socket; None when there is none."""
        now = self._clock.now()
        if isinstance(source, Session):
            return self._receive(self._sockets[source], source.port, source, now)
        port = Port.MAIN if source is self._shared[Port.MAIN] else Port.SESSION
        began = time.thread_time_ns()
        events = self._receive(source, port, None, now)
        self._charge_strangers(time.thread_time_ns() - began)
        return events

    def _receive(
        self, source: SharedSocket | SessionSocket, port: Port, session: Session | None, now: Instant
    ) -> list[Event] | None:
        received = source.receive()
        if isinstance(received, Datagram):
            arrived = Instant(self._clock.now() - received.age_ns)
            endpoint = Endpoint(port, received.local)
            return self.sessions.receive(received.data, Peer(*received.peer), endpoint, now, arrived)
        if session is None or received is None:
            return None
        if received is SendResult.UNREACHABLE:
            session.unreachable = now
            return []
        return self.sessions.refused(session, now)

    def _answer_sync(self, asked: SyncAsked) -> list[Event]:
        """Tell a client the clock; the answer's own stamp is taken just before it is sent."""
        sync, boot = asked.sync, self.sessions.rules.boot
        session_socket = self._sockets.get(asked.session)
        if session_socket is None:
            return []
        reply = SyncReply(sync.id, sync.t1_ns, asked.arrived - boot, self._clock.now() - boot)
        data = encode(reply) + (b"\0" if asked.session.nul else b"")
        if session_socket.send(data) is SendResult.REFUSED:
            return self.sessions.refused(asked.session, self._clock.now())
        return []

    def tell(self, word: str) -> list[Event]:
        """Tell every session of version 2 a word of the referee."""
        return self.apply_events(self.sessions.tell(word, self._clock.now()))

    def _send_reply(self, reply: Reply) -> list[Event]:
        if reply.session is None:
            self._shared[reply.via.port].send(reply.data, reply.to, reply.via.local)
            return []
        session_socket = self._sockets.get(reply.session)
        if session_socket is None or session_socket.send(reply.data) is not SendResult.REFUSED:
            return []
        return self.sessions.refused(reply.session, self._clock.now())

    def _open(self, session: Session) -> bool:
        """Open a socket for a session, in place of the one it may have; False when there is none left."""
        self._close(session)
        try:
            opened = self._shared[session.port].open_session(session.local, session.peer)
        except OSError:
            return False
        opened.stay_local(self.sessions.rules.is_guest(session))
        self._sockets[session] = opened
        self._listen(opened.fileno(), session)
        return True

    def _close(self, session: Session) -> None:
        self._table_is_stale = True
        session_socket = self._sockets.pop(session, None)
        if session_socket is not None:
            del self._sources[session_socket.fileno()]
            session_socket.close()

    def _update_table(self) -> None:
        """Give every session a row: the one it has, or a new one."""
        if not self._table_is_stale:
            return
        rows = new_rows(len(self._sockets))
        old_rows = {session: row for row, session in enumerate(self._in_table)}
        self._in_table = tuple(sorted(self._sockets, key=_robot_of))
        for row, session in enumerate(self._in_table):
            if session in old_rows:
                rows[row] = self._table.rows[old_rows[session]]
        self._table.replace(rows)
        self._table_is_stale = False
        for row, session in enumerate(self._in_table):
            self._table.address(row, _robot_of(session), self._sockets[session].fileno(), session.options)

    def _listen(self, descriptor: int, source: SharedSocket | Session) -> None:
        self._sources[descriptor] = source
        self._poll.register(descriptor, select.EPOLLIN)


def _robot_of(session: Session) -> int:
    return robot_index(session.team, session.number)
