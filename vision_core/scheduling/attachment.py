"""How a process of the service gets at what the supervisor made: memory, events, sockets.

The supervisor passes the numbers of the inherited descriptors in an environment variable, ``PSLV_RESOURCES``.
Everything here is standard library, since the supervisor uses it too.
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
"""Prefix of the records that processes write to show that they are alive."""
PR_SET_PDEATHSIG, PR_SET_NAME = 1, 15
MAX_NAME = 15
"""Length of a process's name in the kernel [bytes]."""


@dataclass(frozen=True, slots=True)
class ChildResources:
    """What the supervisor gives to one child process."""

    process: str
    """The child's name."""
    supervisor: int
    """Process id of the supervisor."""
    boot: int
    """Start of the service [ns of CLOCK_MONOTONIC]; Time counts from here."""
    block: int
    """Descriptor of the database."""
    records: tuple[RecordSpec, ...]
    """All records of the database."""
    wake: int | None
    """Descriptor of the event that releases this process; None: only the clock does."""
    notify: dict[str, tuple[int, ...]]
    """Descriptors of the events to raise after writing a record, by its name."""
    sockets: dict[str, int]
    """Descriptors of sockets by name."""

    def encode(self) -> str:
        """As JSON."""
        return json.dumps(asdict(self))

    @staticmethod
    def decode(text: str) -> "ChildResources":
        """From JSON."""
        table = json.loads(text)
        table["records"] = tuple(RecordSpec(**spec) for spec in table["records"])
        table["notify"] = {name: tuple(fds) for name, fds in table["notify"].items()}
        return ChildResources(**table)

    def descriptors(self) -> tuple[int, ...]:
        """Every descriptor that the child must inherit."""
        wake = () if self.wake is None else (self.wake,)
        raised = [fd for fds in self.notify.values() for fd in fds]
        return (self.block, *wake, *raised, *self.sockets.values())


@dataclass(frozen=True, slots=True)
class Become:
    """The supervisor's message to a warm spare: which process to become. One line of JSON."""

    module: str
    """Main module of that process."""
    resources: ChildResources
    hurried: bool
    """The supervisor has given the spare precedence until its first heartbeat: it must not change its policy."""

    def encode(self) -> bytes:
        """The line, with its end."""
        table = {"module": self.module, "resources": self.resources.encode(), "hurried": self.hurried}
        return json.dumps(table).encode() + b"\n"

    @staticmethod
    def decode(line: bytes) -> "Become":
        """From a line."""
        table = json.loads(line)
        return Become(table["module"], ChildResources.decode(table["resources"]), hurried=table["hurried"])


class Attachment:
    """A child's access to the service. It ends with its supervisor; SIGTERM asks it to stop."""

    def __init__(self, resources: ChildResources) -> None:
        self.resources = resources
        self.store = Store(resources.records, resources.block)
        self.boot = Instant(resources.boot)
        self.stopping = False
        self._heartbeat = self.store.writer(f"{HEARTBEAT}/{resources.process}")

    def stop_on_signals(self) -> None:
        """Let SIGTERM set ``stopping`` and ignore SIGINT, which the supervisor handles."""

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
        """Reset the event, so that the next raise wakes this process again."""
        assert self.resources.wake is not None
        with contextlib.suppress(BlockingIOError):
            os.eventfd_read(self.resources.wake)

    def heartbeat(self, now: Instant) -> None:
        """Show that this process is alive. The first heartbeat says that it is ready to work."""
        self._heartbeat.write(b"", now, now)

    def notify(self, record: str) -> None:
        """Release every process that waits for a record."""
        for descriptor in self.resources.notify.get(record, ()):
            os.eventfd_write(descriptor, 1)


def attach() -> Attachment:
    """Attach to the service that started this process; ends the process when there is none."""
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
    """Have the kernel kill this process when its parent ends for any reason."""
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it had ended before
        os._exit(1)


def name_process(name: str) -> None:
    """Set the name that ``top`` and ``ps`` show for this process, cut to MAX_NAME bytes."""
    ctypes.CDLL(None).prctl(PR_SET_NAME, name.encode()[:MAX_NAME])


def monotonic() -> Instant:
    """Now [ns of CLOCK_MONOTONIC]."""
    return Instant(time.monotonic_ns())
