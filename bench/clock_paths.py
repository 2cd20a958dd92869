"""A client with a clock of its own, and paths that delay, lose, double and reorder, on simulated time.

The server's clock is the truth. Nothing sleeps: an hour of simulated time takes a few seconds.
"""

import heapq
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count

import numpy as np

from vision_core.client.clock_sync import ClockSync
from vision_core.clock import NS_PER_S, Instant
from vision_core.geometry import Floats, frozen
from vision_core.protocol.messages import Sync, SyncReply

TICK_S = 0.01
"""Between two looks at the clock; questions that are due are sent then."""
ANSWER_S = 50e-6
"""Time the server takes for an answer."""
REORDERED_S = 0.03
BOOT = "1"


@dataclass(frozen=True, slots=True)
class ClientClock:
    """The client's clock beside the server's."""

    ahead_s: float = 1000.0
    """By how much the client's clock is ahead at the beginning."""
    skew: tuple[tuple[float, float], ...] = ((0.0, 0.0),)
    """From when on [s], and how much faster than the server's the client's clock runs."""
    steps: tuple[tuple[float, float], ...] = ()
    """When [s], and by how much [s] the client's clock steps forward."""

    def read(self, true_s: float) -> Instant:
        """What the client's clock shows."""
        ends = [begin for begin, _ in self.skew[1:]] + [np.inf]
        drifted = sum(
            max(min(true_s, end) - begin, 0.0) * skew for (begin, skew), end in zip(self.skew, ends, strict=True)
        )
        stepped = sum(step for at, step in self.steps if true_s >= at)
        return Instant(round((true_s + self.ahead_s + drifted + stepped) * NS_PER_S))


@dataclass(frozen=True, slots=True)
class Path:
    """One direction of the network. Probabilities are per datagram."""

    delay_s: float = 150e-6
    jitter_s: float = 0.0
    """Mean of an exponential delay on top."""
    loss: float = 0.0
    duplication: float = 0.0
    reordering: float = 0.0
    """Delayed by REORDERED_S on top, so that later datagrams overtake it."""

    def delays_s(self, random: np.random.Generator) -> Iterator[float]:
        """Delays of the copies of one datagram that arrive."""
        if random.random() < self.loss:
            return
        for _ in range(1 + int(random.random() < self.duplication)):
            late = REORDERED_S if random.random() < self.reordering else 0.0
            yield self.delay_s + random.exponential(self.jitter_s) + late


@dataclass(frozen=True, slots=True)
class Case:
    """What is simulated."""

    there: Path
    back: Path
    clock: ClientClock = field(default_factory=ClientClock)
    duration_s: float = 60.0
    silent_s: tuple[float, float] = (0.0, 0.0)
    """From when until when [s] nothing arrives."""


@dataclass(frozen=True, slots=True)
class Trace:
    """What the client knew at each tick from the first at which it knew the clock; shape (n,) each, read-only [s]."""

    at_s: Floats
    """The truth."""
    told_s: Floats
    """What ClockSync says that the server's clock shows."""
    bound_s: Floats
    client_s: Floats
    """What the client's clock shows."""
    naive_s: Floats
    """What the middle of the last exchange alone says."""

    @property
    def error_s(self) -> Floats:
        """Of what is told."""
        return self.told_s - self.at_s


IDLE = Path(jitter_s=30e-6)
LOADED = Path(jitter_s=1e-3, loss=0.05, duplication=0.02, reordering=0.02)
ASYMMETRIC = Case(Path(1.2e-3), Path(0.2e-3))
CASES = {
    "idle": Case(IDLE, IDLE, ClientClock(skew=((0.0, 30e-6),))),
    "loaded": Case(LOADED, LOADED, ClientClock(skew=((0.0, -40e-6),))),
    "drift": Case(IDLE, IDLE, ClientClock(skew=((0.0, 80e-6),)), 600.0),
    "wandering": Case(LOADED, IDLE, ClientClock(skew=((0.0, -100e-6), (30.0, 90e-6)))),
    "asymmetric": ASYMMETRIC,
    "step": Case(IDLE, IDLE, ClientClock(steps=((30.0, -1.0),))),
}


def simulate(case: Case, seed: int) -> Trace:
    """Run a client for some time. seed: of delays, losses and so on."""
    random, sync, numbers = np.random.default_rng(seed), ClockSync(), count()
    sync.begin(BOOT, case.clock.read(0.0))
    under_way: list[tuple[float, int, Sync | SyncReply]] = []
    rows: list[tuple[float, float, float, float, float]] = []
    naive_ns = 0

    def send(message: Sync | SyncReply, at_s: float, path: Path) -> None:
        for delay_s in path.delays_s(random):
            arrives_s = at_s + delay_s
            if not case.silent_s[0] <= arrives_s < case.silent_s[1]:
                heapq.heappush(under_way, (arrives_s, next(numbers), message))

    for tick in range(round(case.duration_s / TICK_S)):
        at_s = tick * TICK_S
        while under_way and under_way[0][0] <= at_s:
            arrived_s, _, message = heapq.heappop(under_way)
            if isinstance(message, Sync):
                t2_ns, t3_ns = round(arrived_s * NS_PER_S), round((arrived_s + ANSWER_S) * NS_PER_S)
                send(SyncReply(message.id, message.t1_ns, t2_ns, t3_ns), arrived_s + ANSWER_S, case.back)
                continue
            t4 = case.clock.read(arrived_s)
            if sync.answered(message, t4, t4):
                naive_ns = (message.t2_ns - message.t1_ns + message.t3_ns - t4) // 2
        now = case.clock.read(at_s)
        if (question := sync.question(now)) is not None:
            send(question, at_s, case.there)
        told = sync.server_time(now)
        rows.append((at_s, *told, now / NS_PER_S, (now + naive_ns) / NS_PER_S))
    known = np.array([row for row in rows if np.isfinite(row[2])]).reshape(-1, 5)
    return Trace(*(frozen(column.copy()) for column in known.T))
