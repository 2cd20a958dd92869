"""What the supervisor is to start."""

import socket
from dataclasses import dataclass

from vision_core.rtdb.layout import RecordSpec

LOG, OUTPUT = "log", "output"
"""Names of two connected sockets. Processes print to OUTPUT, at which no writer waits; the one that has LOG reads there
and prints to the service's own output. Without them all print to that."""


@dataclass(frozen=True, slots=True)
class ChildPlan:
    """One process."""

    name: str
    module: str
    """Its main module, for ``python -m``."""
    wakes: tuple[str, ...]
    """Records whose writing raises its event."""
    writes: tuple[str, ...]
    """Records that it writes."""
    sockets: tuple[str, ...]
    """Sockets that it inherits, by name."""
    after: str
    """Name of a process that this one waits for: until that has ended if it runs once, else until its first heartbeat
    or crash. Empty: it is started at once."""
    once: bool
    """It ends by itself."""
    heartbeat_s: float
    """A heartbeat that is older is overdue: the process is killed if it is stopped or sleeps."""
    longest_run_s: float
    """A process with an overdue heartbeat that computes is killed after this much processor time [s]."""
    real_time: bool = False
    """It runs tasks with real-time priority. An ordinary process is not disabled for being killed as hung."""
    may_fail: bool = False
    """When it runs once and fails, those that wait for it are started all the same. Otherwise the service ends."""
    spared: bool = True
    """A warm spare may take its place."""
    purpose: str = ""
    """What it does, for a person: "finds robots and ball"."""

    @property
    def title(self) -> str:
        """Its name in a message: "perceive (finds robots and ball)"."""
        return f"{self.name} ({self.purpose})" if self.purpose else self.name


@dataclass(frozen=True, slots=True)
class ServicePlan:
    """The whole service."""

    children: tuple[ChildPlan, ...]
    records: tuple[RecordSpec, ...]
    """Among them ``heartbeat/<name>`` of every child and every spare."""
    initial: dict[str, bytes]
    """First values of records that the supervisor writes."""
    sockets: dict[str, socket.socket]
    """Sockets that were opened for the children, by name. LOG and OUTPUT are the plan's own; who opened the
    others closes them."""
    boot: int
    """Start of the service [ns of CLOCK_MONOTONIC]."""
    spares: tuple[str, ...]
    """Names of the warm spares."""
    control: str
    """Name of the service, by which its control socket is found: "pslv/8000"."""
    spare_module: str
    """Main module of a warm spare; ``vision_core.startup.spare`` says what it must do."""
    check: tuple[str, ...] = ()
    """Command that finds out whether the service could be restarted: what it prints last on standard output says why
    not, when its exit status is not 0. Without it the service cannot be restarted as a whole."""


def log_sockets() -> tuple[socket.socket, socket.socket]:
    """LOG and OUTPUT. Whoever reads learns which process has printed, also what was printed before he began."""
    log, output = socket.socketpair()
    log.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
    output.setblocking(False)
    return log, output
