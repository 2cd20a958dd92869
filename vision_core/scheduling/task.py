"""One line of the task table."""

from dataclasses import dataclass

DRIVER, PERIOD, NONE = "driver", "period", "none"
"""Triggers that are no records: released by a device or by whatever it reads; on a grid in time; a loop of its own."""
HIGHEST_PRIORITY = 90
"""Of a task. What watches over them must come first, and the kernel's own threads before that."""

MAX_RUN_S = 4.0
"""A real-time task that computes for longer without a heartbeat is hung, whatever its period is."""
ORDINARY_MAX_RUN_S = 30.0
"""The same for a task without a priority: it delays no other."""


@dataclass(frozen=True, slots=True)
class Task:
    """What a task is, and when it runs."""

    name: str
    module: str
    """Has ``start(handle)``, which returns what is called at every release; see ``handle``."""
    trigger: str
    """The record whose writing releases it, or DRIVER, PERIOD, NONE."""
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    """Beside ``task/<name>`` and ``timing/<name>``, which every task writes."""
    process: str
    """Tasks that name the same one share it."""
    priority: int = 0
    """SCHED_FIFO, 1..90; 0: an ordinary process."""
    period_s: float = 0.0
    """Of a periodic task; of one that a record triggers the least time between two runs, 0: every time."""
    offset_s: float = 0.0
    """Of the grid, from the start of the service."""
    budget_s: float = 0.0
    """A run that takes longer is an overrun; 0: none is counted."""
    enabled: bool = True
    cores: tuple[int, ...] = ()
    """Where it may run; empty: anywhere."""
    sockets: tuple[str, ...] = ()
    """Sockets of the supervisor that it uses."""
    needs_kernels: bool = True
    """Started only when the kernels are compiled."""

    @property
    def max_run_s(self) -> float:
        """The longest run before the task is taken for hung [s of processor time]."""
        return MAX_RUN_S if self.priority else ORDINARY_MAX_RUN_S

    def rate_hz(self, camera_rate_hz: float) -> float:
        """How often it runs at most: by its period and, unless that alone releases it, by the camera."""
        if self.trigger == PERIOD or self.period_s == 0.0:
            return 1.0 / self.period_s if self.period_s else camera_rate_hz
        return min(1.0 / self.period_s, camera_rate_hz)
