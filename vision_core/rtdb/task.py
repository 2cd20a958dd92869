"""One line of the task table."""

from dataclasses import dataclass

from vision_core.settings.schema import TaskTimes

DRIVER, PERIOD, NONE = "driver", "period", "none"
"""Triggers that are no records: a device, or whatever the task reads; a grid in time; nothing, since it has a loop of
its own."""
HIGHEST_PRIORITY = 90
"""Of a task. The supervisor comes before all tasks, and the kernel's own threads before the supervisor."""

MAX_RUN_S = 4.0
"""A real-time task that computes for longer without a heartbeat is hung, whatever its period is."""
ORDINARY_MAX_RUN_S = 30.0
"""The same for a task without a priority: it delays no other."""


@dataclass(frozen=True, slots=True)
class Task:
    """What a task is, and when it runs."""

    name: str
    module: str
    """Has ``start(handle)``, see ``scheduling.handle``. Empty for a task with a loop of its own, whose main
    module ``app.launch`` knows."""
    trigger: str
    """The record whose writing releases it, or DRIVER, PERIOD, NONE."""
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    """Records beside ``task/<name>`` and ``timing/<name>``, which every task writes."""
    process: str
    """Tasks that name the same one share it."""
    times: TaskTimes
    sockets: tuple[str, ...] = ()
    """Sockets of the supervisor that it uses."""
    needs_kernels: bool = True
    """It is started only when the kernels are compiled."""
    on_frame_path: bool = False
    """No robot is served without it."""
    period_owner: str = ""
    """What decides about its period: "the camera". Empty: its own settings."""
    purpose: str = ""
    """What it does, for a person: "finds robots and ball"."""

    @property
    def own_loop(self) -> bool:
        """It is released by nothing: it cannot be switched off, slowed or given a priority while it runs."""
        return self.trigger == NONE

    @property
    def max_run_s(self) -> float:
        """The longest run before the task is taken for hung [s of processor time]."""
        return MAX_RUN_S if self.times.priority else ORDINARY_MAX_RUN_S

    def rate_hz(self, camera_rate_hz: float) -> float:
        """How often it runs at most: by its period and, unless that alone releases it, by the camera."""
        period_s = self.times.period_s
        if self.trigger == PERIOD or period_s == 0.0:
            return 1.0 / period_s if period_s else camera_rate_hz
        return min(1.0 / period_s, camera_rate_hz)
