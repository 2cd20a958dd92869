"""Damaged datagrams through the decoder and the sessions of the server.

Corpus: every form of the protocol. In a first round its mutations run under a tracer, and those that reach a new line
of ``vision_core.protocol`` join the corpus. Then one process per core mutates the corpus at full speed, and every
datagram goes through ``Sessions.receive``, from an admitted address with sessions, one without, and a stranger, to both
ports, while the clock goes on, sessions are refused and expire, and the server is restarted from its snapshot.

Garbage is collected between datagrams, as in the service. A datagram that takes half of the limit is sent again three
times, and its least time counts: an interrupt of the machine is not the datagram's. The first time has a row as well.

Rows: datagrams, exceptions (0), the slowest datagram by processor time (under 1 ms), replies longer than three times
what a stranger sent (0), more than one reply to a stranger (0), and snapshots that do not restore to what was (0).
There is no baseline.
"""

import gc
import random
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields
from os import sched_getaffinity
from pathlib import Path
from types import FrameType
from typing import Any

import vision_core.protocol
from bench.runner import Row
from vision_core.clock import NS_PER_MS, Instant, ManualClock
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.admission import Admission
from vision_core.protocol.events import Endpoint, Event, Reply, SessionOpened
from vision_core.protocol.lifecycle import Peer, Port, Session
from vision_core.protocol.proofs import key_digest
from vision_core.protocol.rate_limits import AMPLIFICATION
from vision_core.protocol.rules import ServerFacts, SessionRules
from vision_core.protocol.session import Sessions
from vision_core.types.objects import Team

DATAGRAMS = 5_000_000
TRACED = 100_000
SLOWEST_MS = 1.0
REPEATS = 3
SNAPSHOT_EVERY = 10_000
STEP_S = 0.02
"""Of the clock, between two datagrams: rate limits let most of them pass."""
BOOT = Instant(10**9)
COOKIE = b"0123456789abcdef01234567"
"""In the corpus; a sender puts the cookie in its place that it was given last."""
CHALLENGE = b"(challenge "
KEY = "Key_9-" + "k" * 37
CLIENT, OTHER, STRANGER = Peer("127.0.0.1", 40000), Peer("10.0.0.7", 40001), Peer("192.0.2.9", 40002)
PEERS = (CLIENT, CLIENT, OTHER, STRANGER)
SEEDS = (
    b"(init blue 3)", b"(init (team blue) (number 3))\n", b"(INIT Yellow 16)\0",
    b"(init blue 1)(init blue 2)(mirror blue 1)",
    b"(init blue 3 (version 2) (types team) (fov 90 0) (resolution 0.25) (rate 30) (time us) (size half) (sense cw))",
    b"(init blue 3 (version 2) (mirror 4.0187 0.0125935 90000) (extra seq age sent conf flags) (port same))",
    b"(init blue 3 (version 2) (cookie %s) (key %s))" % (COOKIE, KEY.encode()),
    b"(reconnect blue 3 (key %s) (cookie %s))" % (KEY.encode(), COOKIE),
    b"(bye)", b"(bye blue 3)", b"(lag 1.500 0.4 6.5)", b"(lag blue 3 1.500000 0.4 -)", b"(mirror)", b"(mirror blue 3)",
    b"(dispinit (version 2) (cookie %s) (key %s))" % (COOKIE, KEY.encode()), b"(dispinit)", b"(dispinit play_on)",
    b"(set (rate 10) (extra seq))", b"(set blue 3 (types number))", b"(ping)", b"(ping 7)", b"(sync 7 123456789)",
    b"(see 1.5 ((edge) w10-ff) ((ball) -1 0 0))", b"(error not_admitted)", b"(init blue 3 play_on)", b"(sync 7 1 2 3)",
    b"(challenge 0123456789abcdef01234567)", b"(hear 1.5 referee play_on)",
)  # fmt: skip
TOKENS = (
    b"(", b")", b" ", b"\0", b"\n", b"blue", b"yellow", b"0", b"1", b"16", b"17", b"-1", b"1e308", b"nan",
    b"999999999999", b"init", b"set", b"sync", b"ping", b"reconnect", b"version", b"cookie", b"key", b"extra",
    b"mirror", b"fov", b"\xff", b"((",
)  # fmt: skip


@dataclass(slots=True)
class Found:
    """What a process found."""

    datagrams: int = 0
    exceptions: int = 0
    slowest_ns: int = 0
    slowest_once_ns: int = 0
    """With whatever interrupted it."""
    opened_2: int = 0
    """Sessions of version 2."""
    too_long: int = 0
    too_many: int = 0
    unlike: int = 0


class Target:
    """A server's sessions with their clock, and what is wrong about them."""

    def __init__(self, seed: int) -> None:
        self.found = Found()
        self._random = random.Random(seed)
        self._clock = ManualClock(BOOT)
        self._rules = _rules()
        self._sessions = Sessions(self._rules)
        self._cookies: dict[Peer, bytes] = {}

    def feed(self, datagram: bytes) -> None:
        """One datagram, from somebody, to one of the ports."""
        peer, port = self._random.choice(PEERS), self._random.choice((Port.MAIN, Port.SESSION))
        self._clock.advance(STEP_S)
        datagram = datagram.replace(COOKIE, self._cookies.get(peer, COOKIE))
        is_stranger = peer is STRANGER and not self._has_proven(peer)
        endpoint = Endpoint(port, "127.0.0.1")
        events, took_ns = self._timed(datagram, peer, endpoint)
        self.found.slowest_once_ns = max(self.found.slowest_once_ns, took_ns)
        if took_ns > SLOWEST_MS * NS_PER_MS / 2:
            took_ns = min(took_ns, *(self._timed(datagram, peer, endpoint)[1] for _ in range(REPEATS)))
        self.found.slowest_ns = max(self.found.slowest_ns, took_ns)
        self.found.datagrams += 1
        replies = [event for event in events if isinstance(event, Reply)]
        for reply in replies:
            if reply.data.startswith(CHALLENGE):
                self._cookies[peer] = reply.data[len(CHALLENGE) :].rstrip(b")\0")
        self.found.opened_2 += sum(isinstance(one, SessionOpened) and one.session.version > 1 for one in events)
        if is_stranger and not self._has_proven(peer):
            self.found.too_many += len(replies) > 1
            self.found.too_long += any(len(one.data) > AMPLIFICATION * len(datagram) for one in replies)
        self._live_on()

    def _has_proven(self, peer: Peer) -> bool:
        """Has it a session, or is it a monitor?"""
        return self._sessions.monitors.get(peer) is not None or any(one.peer == peer for one in self._sessions)

    def _timed(self, datagram: bytes, peer: Peer, endpoint: Endpoint) -> tuple[list[Event], int]:
        """What follows from a datagram, and how long that took [ns of processor time]."""
        began = time.thread_time_ns()
        events = self._sessions.receive(datagram, peer, endpoint, self._clock.now())
        return events, time.thread_time_ns() - began

    def _live_on(self) -> None:
        """What happens beside datagrams: closed ports, time that passes, a restart."""
        sessions, now = list(self._sessions), self._clock.now()
        if sessions and self._random.random() < 0.01:
            self._sessions.refused(self._random.choice(sessions), now)
        if self._random.random() < 0.02:
            self._sessions.expire(now)
        if self.found.datagrams % SNAPSHOT_EVERY == 0:
            self._restart()

    def _restart(self) -> None:
        sessions = list(self._sessions)
        restored = Sessions.restore(self._rules, self._sessions.snapshot())
        gc.collect()
        names = {field.name for field in fields(Session)} - {"limiter", "claim", "unreachable"}
        pairs = zip(sessions, restored, strict=True)
        unlike = any(getattr(one, name) != getattr(other, name) for one, other in pairs for name in names)
        self.found.unlike += unlike or self._sessions.monitors.to_plain() != restored.monitors.to_plain()


def run(datagrams: int = DATAGRAMS) -> list[Row]:
    """Trace, then feed."""
    corpus, lines = _traced(min(TRACED, datagrams))
    workers = len(sched_getaffinity(0))
    with ProcessPoolExecutor(workers) as pool:
        each = [datagrams // workers] * workers
        found = list(pool.map(_fed, range(1, workers + 1), each, [corpus] * workers))
    total = {name.name: sum(getattr(one, name.name) for one in found) for name in fields(Found)}
    slowest_ms = max(one.slowest_ns for one in found) / NS_PER_MS
    once_ms = max(one.slowest_once_ns for one in found) / NS_PER_MS
    return [
        {"name": "lines of the protocol reached", "value": lines, "unit": ""},
        {"name": "datagrams", "value": total["datagrams"], "unit": "", "goal": f">= {DATAGRAMS}",
         "met": total["datagrams"] >= DATAGRAMS},
        {"name": "sessions of version 2", "value": total["opened_2"], "unit": "", "goal": "> 0",
         "met": total["opened_2"] > 0},
        _none("exceptions", total["exceptions"]),
        {"name": "slowest datagram, processor time", "value": slowest_ms, "unit": "ms", "goal": f"< {SLOWEST_MS:g}",
         "met": slowest_ms < SLOWEST_MS},
        {"name": "slowest datagram at its first time", "value": once_ms, "unit": "ms"},
        _none("replies over three times a stranger's datagram", total["too_long"]),
        _none("datagrams of strangers with more than one reply", total["too_many"]),
        _none("snapshots that restore to something else", total["unlike"]),
    ]  # fmt: skip


def _none(name: str, count: int) -> Row:
    return {"name": name, "value": count, "unit": "", "goal": "0", "met": count == 0}


def _fed(seed: int, count: int, corpus: list[bytes]) -> Found:
    """Feed mutations of a corpus to sessions of its own."""
    target, mutations = Target(seed), _mutations(corpus, random.Random(seed))
    gc.freeze()
    gc.disable()
    for _ in range(count):
        datagram = next(mutations)
        try:
            target.feed(datagram)
        except Exception as error:  # noqa: BLE001 (that is what is looked for)
            print(f"{datagram!r}: {error!r}", file=sys.stderr)
            target.found.exceptions += 1
    return target.found


def _traced(count: int) -> tuple[list[bytes], int]:
    """The corpus with every mutation that reached new lines, and the number of lines."""
    corpus, target, seen = list(SEEDS), Target(0), set[tuple[str, int]]()
    folder = str(Path(vision_core.protocol.__file__).parent)

    def tracer(frame: FrameType, event: str, _argument: Any) -> Any:
        if not frame.f_code.co_filename.startswith(folder):
            return None
        if event == "line":
            seen.add((frame.f_code.co_filename, frame.f_lineno))
        return tracer

    mutations = _mutations(corpus, random.Random(0))
    for number in range(count):
        datagram = SEEDS[number] if number < len(SEEDS) else next(mutations)
        before = len(seen)
        sys.settrace(tracer)
        try:
            target.feed(datagram)
        finally:
            sys.settrace(None)
        if len(seen) > before and number >= len(SEEDS):
            corpus.append(datagram)  # the generator mutates it from now on
    return corpus, len(seen)


def _mutations(corpus: list[bytes], chance: random.Random) -> Iterator[bytes]:
    """Mutations of the corpus without end, up to 1100 bytes each."""
    while True:
        data = bytearray(chance.choice(corpus))
        for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
            at = chance.randrange(len(data) + 1)
            match chance.randrange(6):
                case 0:
                    data[at : at + 1] = bytes([chance.randrange(256)])
                case 1:
                    del data[at : at + chance.randrange(1, 9)]
                case 2:
                    data[at:at] = chance.choice(TOKENS)
                case 3:
                    data[at:at] = data[at : at + chance.randrange(1, 60)]
                case 4:
                    other = chance.choice(corpus)
                    data[at:] = other[chance.randrange(len(other) + 1) :]
                case 5:
                    data += chance.choice(corpus)
        yield bytes(data[:1100])


def _rules() -> SessionRules:
    """Two admitted networks, a key for blue, three robots each."""
    mirrors = {(team, number): PAPER_MIRROR for team in Team for number in range(1, 4)}
    ports = {Port.MAIN: 6000, Port.SESSION: 6001}
    facts = ServerFacts(ports, 33.3, dict.fromkeys(Team, 90.0), "bench", (2800.0, 2300.0))
    admission = Admission.from_subnets(["10.0.0.0/24"])
    return SessionRules(
        BOOT, 3, 600.0, 3.6, mirrors, admission, facts, keys={Team.BLUE: key_digest(KEY)}, monitor_key=key_digest(KEY)
    )
