"""What a task is given: its line of the table, the records on it, and a way to wait that keeps up its heartbeat.

A task is a module with ``start(handle)``: it prepares whatever takes time and returns a ``Step``, which is then called
at every release. The handle refuses records that the task's line does not name, so the table is always true.
"""

from collections.abc import Callable
from typing import TypeAlias, TypeVar

from vision_core.clock import MonotonicClock, after, seconds_between
from vision_core.errors import ServiceError
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb.items import Item, ItemReader, ItemWriter
from vision_core.rtdb.slots import SlotReader, SlotWriter
from vision_core.rtdb.task import Task
from vision_core.scheduling.attachment import Attachment
from vision_core.scheduling.realtime import sleep_until
from vision_core.scheduling.rehearser import Rehearsal
from vision_core.scheduling.releases import Release, StepResult
from vision_core.settings.schema import Settings

T = TypeVar("T")
Step: TypeAlias = Callable[[Release], StepResult]
"""One run: RAN, or IDLE when there was nothing to do, or a StepResult with more to report."""
HEARTBEAT_EVERY_S = 0.1


class Handle:
    """One task's access to the service."""

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
        """Sequence number of each output when it last released other tasks."""
        self.rehearsal: Rehearsal | None = None
        self._on_switch: list[Callable[[], object]] = []

    @property
    def stopping(self) -> bool:
        """The service stops: the step should return soon."""
        return self.attachment.stopping

    def reader(self, item: Item[T]) -> ItemReader[T]:
        """Read a record. Raises ServiceError when the task's line does not name it."""
        return item.over_reader(self.raw_reader(item.spec.name))

    def writer(self, item: Item[T]) -> ItemWriter[T]:
        """Write a record. Raises ServiceError when the task's line does not name it."""
        return item.over_writer(self.raw_writer(item.spec.name))

    def raw_reader(self, record: str) -> SlotReader:
        """Read the bytes of a record. Raises ServiceError when the task's line does not name it."""
        self._check("reads", record, self.task.reads)
        return self.attachment.store.reader(record)

    def raw_writer(self, record: str) -> SlotWriter:
        """Write the bytes of a record. Raises ServiceError when the task's line does not name it."""
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
        """Release the tasks that wait for a record at once; without this they are released after the run."""
        self.notified[record] = self.outputs[record].sequence
        self.attachment.notify(record)

    def listen(self, descriptor: int, handler: Callable[[], object]) -> None:
        """Call a handler whenever a descriptor is readable, between runs."""
        self.listeners[descriptor] = handler

    def rehearse_with(self, rehearsal: Rehearsal) -> None:
        """Repeat the last run shortly before the next release, and undo it: see ``rehearser``."""
        self.rehearsal = rehearsal

    def every_turn(self, callback: Callable[[], object]) -> None:
        """Call a function after every run and every wait, at least ten times a second."""
        self.idle_callbacks.append(callback)

    def when_switched(self, callback: Callable[[], object]) -> None:
        """Call a function when the task is switched off or on, to drop work that would be out of date."""
        self._on_switch.append(callback)

    def switch(self) -> None:
        """Call the functions of ``when_switched``."""
        for callback in self._on_switch:
            callback()

    def sleep(self, duration_s: float) -> None:
        """Sleep [s] and keep up the heartbeat; returns early when the service stops."""
        end = after(self.clock.now(), duration_s)
        while (now := self.clock.now()) < end and not self.stopping:
            sleep_until(min(end, after(now, HEARTBEAT_EVERY_S)))
            self.attachment.heartbeat(self.clock.now())

    def wait(self, timeout_s: float) -> bool:
        """Wait for a release of this process and keep up the heartbeat; False after the timeout [s].

        A process that only the clock releases sleeps.
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
