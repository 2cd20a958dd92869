"""What a task is given: its line of the table, the records on it, and a way to wait without being taken for dead.

A task is a module with ``start(handle)``: it prepares whatever takes time and returns a ``Step``, which is then called
at every release. The handle refuses records that the task's line does not name, so the table cannot lie.
"""

from collections.abc import Callable
from typing import TypeAlias, TypeVar

from vision_core.clock import MonotonicClock, after, seconds_between
from vision_core.errors import ServiceError
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb.items import Item, ItemReader, ItemWriter
from vision_core.rtdb.slots import SlotReader, SlotWriter
from vision_core.scheduling.attachment import Attachment
from vision_core.scheduling.realtime import sleep_until
from vision_core.scheduling.releases import Release
from vision_core.scheduling.task import Task
from vision_core.settings.schema import Settings

T = TypeVar("T")
Step: TypeAlias = Callable[[Release], bool | None]
"""One run; False: there was nothing to do, and it does not count."""
HEARTBEAT_EVERY_S = 0.1


class Handle:
    """One task's hold on the service."""

    def __init__(self, task: Task, attachment: Attachment, settings: Settings, camera: CameraSetup) -> None:
        self.task = task
        self.settings = settings
        self.camera = camera
        """The camera that the task works for; one object for all tasks of a process."""
        self.attachment = attachment
        self.clock = MonotonicClock()
        self.note = ""
        """What a person should know about the task just now."""
        self.listeners: dict[int, Callable[[], object]] = {}
        self.idle_callbacks: list[Callable[[], object]] = []
        self.outputs: dict[str, SlotWriter] = {}
        self.notified: dict[str, int] = {}
        """How often each output was written when it last released somebody."""
        self._on_pause: list[Callable[[], object]] = []

    @property
    def stopping(self) -> bool:
        """The supervisor said stop."""
        return self.attachment.stopping

    def reader(self, item: Item[T]) -> ItemReader[T]:
        """Read a record. Raises ServiceError when the task's line does not name it."""
        return item.over_reader(self.raw_reader(item.spec.name))

    def writer(self, item: Item[T]) -> ItemWriter[T]:
        """Write a record. Raises ServiceError when the task's line does not name it."""
        return item.over_writer(self.raw_writer(item.spec.name))

    def raw_reader(self, record: str) -> SlotReader:
        """A record's ring, to read. Raises ServiceError when the task's line does not name it."""
        self._check("reads", record, self.task.reads)
        return self.attachment.store.reader(record)

    def raw_writer(self, record: str) -> SlotWriter:
        """A record's ring, to write. Raises ServiceError when the task's line does not name it."""
        self._check("writes", record, self.task.writes)
        if record not in self.outputs:
            self.outputs[record] = self.attachment.store.writer(record)
        return self.outputs[record]

    def _check(self, verb: str, record: str, named: tuple[str, ...]) -> None:
        if record not in named:
            raise ServiceError(
                f"task {self.task.name} {verb} {record}",
                found="its line of the task table does not say so",
                accepted=", ".join(named) or "nothing",
            )

    def notify(self, record: str) -> None:
        """Release those who wait for a record, now; after a run this happens by itself."""
        self.notified[record] = self.outputs[record].sequence
        self.attachment.notify(record)

    def listen(self, descriptor: int, handler: Callable[[], object]) -> None:
        """Call a handler whenever a descriptor is readable, between runs."""
        self.listeners[descriptor] = handler

    def every_turn(self, callback: Callable[[], object]) -> None:
        """Call something after every run and wait, ten times a second at least."""
        self.idle_callbacks.append(callback)

    def when_switched(self, forget: Callable[[], object]) -> None:
        """Call something when the task is switched off or on: what it had begun is of long ago then."""
        self._on_pause.append(forget)

    def pause(self) -> None:
        """The task is switched off or on."""
        for forget in self._on_pause:
            forget()

    def sleep(self, duration_s: float) -> None:
        """Sleep [s] without being taken for dead; shorter when the service stops."""
        end = after(self.clock.now(), duration_s)
        while (now := self.clock.now()) < end and not self.stopping:
            sleep_until(min(end, after(now, HEARTBEAT_EVERY_S)))
            self.attachment.heartbeat(self.clock.now())

    def wait(self, timeout_s: float) -> bool:
        """Wait for what releases this process, without being taken for dead; False after the timeout [s].

        Who is released by the clock alone sleeps.
        """
        if self.attachment.resources.wake is None:
            self.sleep(timeout_s)
            return False
        end = after(self.clock.now(), timeout_s)
        while True:
            left_s = seconds_between(self.clock.now(), end)
            if self.attachment.wait(max(min(left_s, HEARTBEAT_EVERY_S), 0.0)):
                return True
            self.attachment.heartbeat(self.clock.now())
            if left_s <= HEARTBEAT_EVERY_S or self.stopping:
                return False
