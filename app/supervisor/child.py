"""One process of the service: start, watch, end, start again."""

import os
import signal
import subprocess
import sys
from dataclasses import dataclass, field

from app.supervisor.plan import ChildPlan
from vision_core.clock import NS_PER_S
from vision_core.rtdb.attachment import VARIABLE, HandDown
from vision_core.rtdb.slots import SlotReader

CRASHES_TO_DISABLE = 5
CRASH_WINDOW_S = 60.0
FIRST_DELAY_S = 0.25
START_PATIENCE_S = 60.0
"""A process that has not shown a first heartbeat by then is taken for hung."""


@dataclass(slots=True)
class Child:
    """A process and its history."""

    plan: ChildPlan
    handed: HandDown
    heartbeat: SlotReader
    state: str = "waiting"
    detail: str = ""
    restarts: int = 0
    process: subprocess.Popen[bytes] | None = None
    pidfd: int | None = None
    started: int = 0
    due: int = 0
    """When to start again [ns]."""
    ends: list[int] = field(default_factory=list)
    """When it ended without having been asked [ns], over the last minute."""

    @property
    def pid(self) -> int | None:
        return self.process.pid if self.process is not None else None

    def start(self, now: int) -> None:
        """Start the process."""
        environment = os.environ | {VARIABLE: self.handed.encode(), "PYTHONUNBUFFERED": "1"}
        self.process = subprocess.Popen(
            [sys.executable, "-m", self.plan.module],
            env=environment,
            pass_fds=self.handed.descriptors(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE if self.plan.once else None,
            process_group=0,  # a Ctrl-C at the terminal reaches the supervisor alone
        )
        self.pidfd = os.pidfd_open(self.process.pid)
        self.started = now
        self.state = "starting"

    def has_ended(self) -> bool:
        """Has the process ended? Takes its exit status."""
        return self.process is not None and self.process.poll() is not None

    def bury(self, now: int) -> None:
        """Note the end of a process and plan what follows."""
        assert self.process is not None
        status = self.process.returncode
        self._forget()
        if self.plan.once and status == 0:
            self.state = "done"
            return
        how = f"signal {signal.Signals(-status).name}" if status < 0 else f"exit status {status}"
        self.ends = [end for end in self.ends if now - end < CRASH_WINDOW_S * NS_PER_S] + [now]
        if self.plan.once:
            self.state, self.detail = "disabled", f"ended with {how}"
        elif len(self.ends) >= CRASHES_TO_DISABLE:
            self.state = "disabled"
            self.detail = f"{len(self.ends)} ends within a minute, the last with {how}"
        else:
            delay_s = 0.0 if len(self.ends) == 1 else FIRST_DELAY_S * 2.0 ** (len(self.ends) - 2)
            self.due = now + int(delay_s * NS_PER_S)
            self.state, self.detail = "restarting", f"ended with {how}"
            self.restarts += 1

    def is_silent(self, now: int) -> bool:
        """Has its heartbeat stayed away for too long? The first one tells that it runs."""
        glance = self.heartbeat.glance()
        if glance is None or glance.written < self.started:
            return now - self.started > START_PATIENCE_S * NS_PER_S
        if self.state == "starting":
            self.state, self.detail = "running", ""
        return not self.plan.once and now - glance.written > self.plan.heartbeat_s * NS_PER_S

    def signal(self, number: signal.Signals) -> None:
        """Send a signal if the process still runs."""
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(number)

    def stop_for_good(self) -> None:
        """Kill what is left of it."""
        if self.process is not None:
            self.signal(signal.SIGKILL)
            self.process.wait()
            self._forget()
        self.state = "stopped"

    def _forget(self) -> None:
        if self.process is not None and self.process.stdout is not None:
            self.process.stdout.close()
        if self.pidfd is not None:
            os.close(self.pidfd)
        self.process = self.pidfd = None
