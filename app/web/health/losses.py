"""What was lost in the last minute: images that a task skipped, runs that took too long, datagrams not sent."""

from collections import Counter, deque
from collections.abc import Iterator
from dataclasses import dataclass, field

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Cause, Subject
from vision_core.clock import Instant, seconds_between
from vision_core.rtdb import records

WINDOW_S = 60.0
EVERY_S = 1.0
"""Counts are kept once in this time."""
MAX_LOST = 0.01
"""Share of a minute's images or datagrams that may be lost: now and then one is, on every machine."""
HOLD_S = 1.0
"""A count that crosses the limit again and again gives one steady message: see ``hysteresis``."""
MISSED, OVERRUNS, DROPPED = "missed", "overruns", "dropped"

_Key = tuple[str, str, int]
"""What is counted, of which task or client, since when: its process or its session."""


@dataclass(frozen=True, slots=True)
class Losses:
    """What was lost in the last minute."""

    missed: Counter[str] = field(default_factory=Counter)
    """Releases that passed without a run, by the task's name."""
    overruns: Counter[str] = field(default_factory=Counter)
    """Runs that took longer than the budget, by the task's name."""
    dropped: Counter[str] = field(default_factory=Counter)
    """Datagrams that the network refused, by the robot's name: blue 3."""


class LastMinute:
    """Remembers the counts of a minute; they begin anew with a process or session."""

    def __init__(self) -> None:
        self._kept: deque[tuple[Instant, dict[_Key, int]]] = deque()

    def losses(self, snapshot: ServiceSnapshot) -> Losses:
        """What was lost in the minute before a snapshot, which is not older than the one before it."""
        newest = dict(_counts(snapshot))
        if not self._kept or seconds_between(self._kept[-1][0], snapshot.now) >= EVERY_S:
            self._kept.append((snapshot.now, newest))
        while len(self._kept) > 1 and seconds_between(self._kept[1][0], snapshot.now) >= WINDOW_S:
            self._kept.popleft()
        before = self._kept[0][1]
        found = Losses()
        for (what, name, since), count in newest.items():
            lost = count - before.get((what, name, since), 0)
            if lost > 0:
                getattr(found, what)[name] += lost
        return found


def loss_causes(snapshot: ServiceSnapshot, losses: Losses) -> Iterator[Cause]:
    """Losses that are more than the occasional one."""
    images = WINDOW_S * snapshot.camera.rate_hz
    all_tasks = losses.missed + losses.overruns
    late = Counter({task: count for task, count in all_tasks.items() if _is_urgent(task, snapshot)})
    if late and max(late.values()) > MAX_LOST * images:
        text = f"{late.total()} times in the last minute a task was late or skipped an image"
        advice = "Close other programs on this computer, or let the watchers run less often on the timing page."
        yield Cause("misses", Subject.MISSES, text, advice, _listed(late), HOLD_S)
    if losses.dropped and max(losses.dropped.values()) > MAX_LOST * images:
        text = f"{losses.dropped.total()} datagrams were dropped in the last minute"
        advice = "Check the network cable and switch, and use cable instead of wireless."
        yield Cause("drops", Subject.DROPS, text, advice, _listed(losses.dropped), HOLD_S)


def _counts(snapshot: ServiceSnapshot) -> Iterator[tuple[_Key, int]]:
    for name, timed in snapshot.tasks.items():
        yield (MISSED, name, timed.value.pid), timed.value.missed
        yield (OVERRUNS, name, timed.value.pid), timed.value.overruns
    serving = snapshot.of(records.SERVING)
    for client in serving.value.clients if serving else ():
        yield (DROPPED, f"{client.team.value} {client.number}", client.since), client.dropped


def _is_urgent(name: str, snapshot: ServiceSnapshot) -> bool:
    """Does a task hand on images, or run with real-time priority?"""
    task = snapshot.task(name)
    return task.on_frame_path or task.times.priority > 0


def _listed(counts: Counter[str]) -> str:
    """The largest counts in words: "perceive 12, serve 4"."""
    return ", ".join(f"{name} {count}" for name, count in counts.most_common(4))
