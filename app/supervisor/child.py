"""One process of the service: start, watch, end, start again."""

import json
import os
import signal
import subprocess
import sys
from dataclasses import dataclass, field
from typing import Any

from app.supervisor.plan import ChildPlan
from app.supervisor.priorities import hurry, hurry_to_end, settle
from app.supervisor.vitals import Silence, silence_of
from vision_core.clock import NS_PER_S
from vision_core.rtdb.slots import SlotReader
from vision_core.scheduling.attachment import VARIABLE, ChildResources

CRASHES_TO_DISABLE = 5
CRASH_WINDOW_S = 60.0
STEADY_S = 5.0
"""A process that has lived for so long is replaced at once, whatever ended it; one that has not"""
FIRST_DELAY_S = 0.25
"""the second time after this, and each further time after twice as long."""
START_PATIENCE_S = 60.0
"""A process that has not beaten once by then is taken for hung; a machine under load is slow to import."""
WARM_PATIENCE_S = 10.0
"""The same for a spare that has taken a place: it has everything, but may have to open a camera."""
MAX_DETAIL = 200
SETTLED = ("running", "done", "disabled")
"""States of a child that nobody waits for."""


@dataclass(slots=True)
class Child:
    """A process and its history. A warm spare is one as well: it takes orders."""

    plan: ChildPlan
    resources: ChildResources
    heartbeat: SlotReader
    arguments: tuple[str, ...] = ()
    inherits: tuple[int, ...] = ()
    """Descriptors to pass on beside those that it is told of."""
    takes_orders: bool = False
    """Its standard input is a pipe."""
    state: str = "waiting"
    detail: str = ""
    restarts: int = 0
    process: subprocess.Popen[bytes] | None = None
    pidfd: int | None = None
    started: int = 0
    patience_s: float = START_PATIENCE_S
    """For the first beat."""
    last_heartbeat: int = 0
    """When it last said that it lives [ns]; 0: not since its start."""
    silence: Silence | None = None
    """Its beat has stayed away for too long."""
    killed: bool = False
    """It did not answer and was sent SIGKILL."""
    due: int = 0
    """When to start again [ns]."""
    ends: list[int] = field(default_factory=list)
    """When it ended without having been asked [ns], over the last minute."""
    ended: int = 0
    """When it last did."""
    consecutive_crashes: int = 0
    """How often in a row it did so soon after its start."""

    @property
    def pid(self) -> int | None:
        return self.process.pid if self.process is not None else None

    def row(self) -> dict[str, Any]:
        """Its line of the table of processes."""
        return {
            "name": self.plan.name,
            "pid": self.pid,
            "state": self.state,
            "restarts": self.restarts,
            "detail": self.detail[:MAX_DETAIL],
        }

    def start(self, now: int) -> None:
        """Start the process; that the machine has no room for it counts as its end."""
        self.started = now
        environment = os.environ | {VARIABLE: self.resources.encode(), "PYTHONUNBUFFERED": "1"}
        try:
            process = subprocess.Popen(
                [sys.executable, "-m", self.plan.module, *self.arguments],
                env=environment,
                pass_fds=(*self.resources.descriptors(), *self.inherits),
                stdin=subprocess.PIPE if self.takes_orders else subprocess.DEVNULL,
                stdout=subprocess.PIPE if self.plan.once else None,
                bufsize=0,
                process_group=0,  # a Ctrl-C at the terminal reaches the supervisor alone
            )
        except OSError as error:
            self._failed(now, f"could not be started: {error.strerror}")
            return
        self._adopt(process, os.pidfd_open(process.pid), now, START_PATIENCE_S)

    def hand_over(self, child: "Child", now: int) -> bool:
        """Have the process of this spare take a child's place; False when it does not take the order."""
        assert self.process is not None
        assert self.process.stdin is not None
        assert self.pidfd is not None
        order = json.dumps({"module": child.plan.module, "handed": child.resources.encode()}).encode() + b"\n"
        pipe = self.process.stdin.fileno()
        os.set_blocking(pipe, False)
        hurry(self.process.pid)
        try:
            taken = os.write(pipe, order) == len(order)
        except OSError:  # it has just ended
            taken = False
        if not taken:
            self.signal(signal.SIGKILL)
            return False
        self.process.stdin.close()
        child._adopt(self.process, self.pidfd, now, WARM_PATIENCE_S)
        self.process = self.pidfd = None
        self.state = "waiting"
        return True

    def has_ended(self) -> bool:
        """Has the process ended? Takes its exit status."""
        return self.process is not None and self.process.poll() is not None

    def reap(self, now: int) -> None:
        """Note the end of a process and plan what follows."""
        assert self.process is not None
        status = self.process.returncode
        self._forget()
        if self.plan.once and status == 0:
            self.state = "done"
            return
        self._failed(now, f"ended with {_in_words(status)}")

    def re_enable(self, now: int) -> None:
        """Try a disabled process again, as if it had never ended."""
        self.ends.clear()
        self.consecutive_crashes = 0
        self.state, self.due, self.ended = "restarting", now, now
        self.restarts += 1

    def note_heartbeat(self) -> None:
        """See when it last said that it lives. The first time tells that it runs."""
        view = self.heartbeat.view()
        if view is not None and view.written >= self.started:
            self.last_heartbeat = view.written
            if self.state == "starting" and self.pid is not None:
                settle(self.pid)
                self.state = "running"

    def is_hung(self, now: int, watched: int) -> bool:
        """Does it hang? watched: since when a beat that stays away would have been noticed [ns].

        Who computes, or waits for a processor, does not before it has had its time of the processor.
        """
        if self.pid is None or (overdue_at := self.overdue_at(watched)) is None:
            return False
        if now <= overdue_at:
            self.silence = None
            return False
        if self.silence is None:
            self.silence = silence_of(self.pid, now)
        return self.silence.is_hung(self.pid, now, self.plan.longest_run_s if self.last_heartbeat else self.patience_s)

    def overdue_at(self, watched: int) -> int | None:
        """When its silence is too long, if it goes on [ns]; None when nothing is expected of it."""
        if self.pid is None or self.killed or (self.plan.once and self.last_heartbeat):
            return None
        patience_s = self.plan.heartbeat_s if self.last_heartbeat else self.patience_s
        return max(self.last_heartbeat, self.started, watched) + round(patience_s * NS_PER_S)

    def kill(self) -> None:
        """End it, since it hangs."""
        if self.pid is not None:
            self.signal(signal.SIGKILL)
            hurry_to_end(self.pid)
            self.killed = True

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

    def _adopt(self, process: subprocess.Popen[bytes], pidfd: int, now: int, patience_s: float) -> None:
        self.process, self.pidfd = process, pidfd
        self.started, self.patience_s = now, patience_s
        self.last_heartbeat, self.silence, self.killed = 0, None, False
        self.state = "starting"

    def _failed(self, now: int, how: str) -> None:
        """It ended: now, or later, or never again."""
        self.ends = [end for end in self.ends if now - end < CRASH_WINDOW_S * NS_PER_S] + [now]
        self.ended = now
        self.state, self.detail = "disabled", how
        if self.plan.once:
            return
        if len(self.ends) >= CRASHES_TO_DISABLE:
            self.detail = f"{len(self.ends)} ends within a minute, the last {how.removeprefix('ended ')}"
            return
        self.consecutive_crashes = self.consecutive_crashes + 1 if now - self.started < STEADY_S * NS_PER_S else 0
        delay_s = FIRST_DELAY_S * 2.0 ** (self.consecutive_crashes - 2) if self.consecutive_crashes > 1 else 0.0
        self.due = now + int(delay_s * NS_PER_S)
        self.state = "restarting"
        self.restarts += 1

    def _forget(self) -> None:
        if self.process is not None:
            for pipe in (self.process.stdin, self.process.stdout):
                if pipe is not None:
                    pipe.close()
        if self.pidfd is not None:
            os.close(self.pidfd)
        self.process = self.pidfd = None


def _in_words(status: int) -> str:
    """What ended a process: "exit status 3", "signal SIGKILL"."""
    if status >= 0:
        return f"exit status {status}"
    named = {number.value: number.name for number in signal.Signals}  # real-time signals have no names
    return f"signal {named.get(-status, -status)}"
