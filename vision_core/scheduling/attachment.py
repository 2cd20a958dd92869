"""How a child process gets hold of what the supervisor made: memory, events, sockets.

The supervisor writes one environment variable, ``PSLV_RESOURCES``, with the numbers of the descriptors
that it passes on. Everything here is standard library, since the supervisor uses it too.
"""

import contextlib
import ctypes
import json
import os
import select
import signal
import sys
import time
from dataclasses import asdict, dataclass
from types import FrameType

from vision_core.clock import Instant
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.store import Store

VARIABLE = "PSLV_RESOURCES"
HEARTBEAT = "heartbeat"
"""Record of each process by which it says that it lives."""
PR_SET_PDEATHSIG, PR_SET_NAME = 1, 15
MAX_NAME = 15
"""Of a process, as the kernel keeps it [bytes]."""


@dataclass(frozen=True, slots=True)
class ChildResources:
    """What the supervisor hands to one child."""

    process: str
    supervisor: int
    """Process id of the supervisor."""
    boot: int
    """Start of the service [ns of CLOCK_MONOTONIC]; Time counts from here."""
    block: int
    """Descriptor of the database."""
    records: tuple[RecordSpec, ...]
    wake: int | None
    """Event that releases this process."""
    notify: dict[str, tuple[int, ...]]
    """Events to raise after writing a record."""
    sockets: dict[str, int]

    def encode(self) -> str:
        return json.dumps(asdict(self))

    @staticmethod
    def decode(text: str) -> "ChildResources":
        table = json.loads(text)
        table["records"] = tuple(RecordSpec(**spec) for spec in table["records"])
        table["notify"] = {name: tuple(fds) for name, fds in table["notify"].items()}
        return ChildResources(**table)

    def descriptors(self) -> tuple[int, ...]:
        """Every descriptor that must be passed on."""
        wake = () if self.wake is None else (self.wake,)
        raised = [fd for fds in self.notify.values() for fd in fds]
        return (self.block, *wake, *raised, *self.sockets.values())


class Attachment:
    """A child's hold on the service. Ends with its supervisor; SIGTERM asks it to stop."""

    def __init__(self, resources: ChildResources) -> None:
        self.resources = resources
        self.store = Store(resources.records, resources.block)
        self.boot = Instant(resources.boot)
        self.stopping = False
        self._heartbeats = self.store.writer(f"{HEARTBEAT}/{resources.process}")

    def stop_on_signals(self) -> None:
        """SIGTERM sets ``stopping``; SIGINT is the supervisor's business."""

        def stop(_number: int, _frame: FrameType | None) -> None:
            self.stopping = True

        signal.signal(signal.SIGTERM, stop)
        signal.signal(signal.SIGINT, signal.SIG_IGN)

    def wait(self, timeout_s: float) -> bool:
        """Wait for the event that releases this process; False after the timeout. Several raises count once."""
        assert self.resources.wake is not None
        poller = select.poll()
        poller.register(self.resources.wake, select.POLLIN)
        if not poller.poll(timeout_s * 1e3):
            return False
        self.clear()
        return True

    def clear(self) -> None:
        """Take note of the event: what raises it after this is news."""
        assert self.resources.wake is not None
        with contextlib.suppress(BlockingIOError):
            os.eventfd_read(self.resources.wake)

    def heartbeat(self, now: Instant) -> None:
        """Say that this process lives. The first time says that it is ready to work."""
        self._heartbeats.write(b"", now, now)

    def notify(self, record: str) -> None:
        """Release everybody who waits for a record."""
        for descriptor in self.resources.notify.get(record, ()):
            os.eventfd_write(descriptor, 1)


def attach() -> Attachment:
    """Attach to the service that started this process; exits when there is none."""
    text = os.environ.get(VARIABLE)
    if text is None:
        sys.exit("this process is a part of the service and is started by `pslv serve`")
    resources = ChildResources.decode(text)
    end_with(resources.supervisor)
    name_process(f"pslv:{resources.process}")
    attachment = Attachment(resources)
    attachment.stop_on_signals()
    return attachment


def end_with(parent: int) -> None:
    """Have the kernel kill this process when its parent dies, however it dies."""
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it died before we asked
        os._exit(1)


def name_process(name: str) -> None:
    """Let ``top`` and ``ps`` call this process so; what is too long is cut."""
    ctypes.CDLL(None).prctl(PR_SET_NAME, name.encode()[:MAX_NAME])


def monotonic() -> Instant:
    """Now [ns of CLOCK_MONOTONIC]."""
    return Instant(time.monotonic_ns())
