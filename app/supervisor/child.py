"""One process of the service: start, watch, end, start again."""

import os
import signal
import subprocess
import sys
from dataclasses import dataclass, field
from typing import Any

from app.supervisor.lifecycle import Change, next_state
from app.supervisor.plan import ChildPlan
from app.supervisor.priorities import hurry, hurry_to_end, settle
from app.supervisor.vitals import Silence, silence_of
from vision_core.clock import NS_PER_S
from vision_core.rtdb.process_state import ProcessState
from vision_core.rtdb.slots import SlotReader
from vision_core.scheduling.attachment import VARIABLE, Become, ChildResources

CRASHES_TO_DISABLE = 5
CRASH_WINDOW_S = 60.0
STEADY_S = 5.0
"""A process that ran for at least this long is started again at once when it ends."""
FIRST_DELAY_S = 0.25
"""A process that crashes twice in a row, each time sooner than STEADY_S after its start, waits for this long before the
next start; the delay doubles with every further crash in a row."""
MAX_DELAY_S = 30.0
START_PATIENCE_S = 60.0
"""A process without a first heartbeat after this time is hung; under load, imports take long."""
WARM_PATIENCE_S = 10.0
"""The same for a warm spare that has taken a place: its imports are done, but it may have to open a camera."""
MAX_DETAIL = 200


@dataclass(slots=True)
class Child:
    """A process and its history. A warm spare is one as well: it waits for instructions on its standard input."""

    plan: ChildPlan
    resources: ChildResources
    heartbeat: SlotReader
    arguments: tuple[str, ...] = ()
    inherits: tuple[int, ...] = ()
    """Descriptors that it inherits beside those of its resources."""
    output: int | None = None
    """Descriptor to which it prints; None: the service's own output."""
    is_spare: bool = False
    """Its standard input is a pipe, through which it learns which process to become."""
    state: ProcessState = ProcessState.WAITING
    detail: str = ""
    restarts: int = 0
    process: subprocess.Popen[bytes] | None = None
    pidfd: int | None = None
    started: int = 0
    patience_s: float = START_PATIENCE_S
    """For the first heartbeat."""
    hurried: bool = False
    """``priorities.hurry`` gave it precedence, which ends with its first heartbeat."""
    last_heartbeat: int = 0
    """Time of its newest heartbeat [ns]; 0: none since its start."""
    silence: Silence | None = None
    """What it does while its heartbeat is overdue; None while it is not."""
    killed: bool = False
    """It was hung and was sent SIGKILL."""
    due: int = 0
    """When to start it again [ns]."""
    crashes: list[int] = field(default_factory=list)
    """Times of its crashes over the last minute [ns], as far as they count towards disabling it."""
    ended: int = 0
    """Time of its last end [ns]."""
    consecutive_crashes: int = 0
    """Crashes in a row that came sooner than STEADY_S after the start."""

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

    @property
    def holds_others(self) -> bool:
        """Do those that are to be started after it still wait?"""
        is_new = self.state in (ProcessState.WAITING, ProcessState.STARTING)
        return is_new or (self.plan.once and self.state is ProcessState.RUNNING)

    @property
    def is_warm(self) -> bool:
        """Does it wait for ``begin``, with everything loaded?"""
        return self.state is ProcessState.RUNNING and self.process is not None and self.process.stdin is not None

    def start(self, now: int) -> None:
        """Start the process. When the machine cannot start it, that counts as a crash."""
        self._start([self.plan.module, *self.arguments], waits=self.is_spare, now=now)

    def start_warm(self, spare_module: str, now: int) -> None:
        """Start the process as a warm spare that waits for ``begin`` to become this child."""
        self._start([spare_module, self.plan.module], waits=True, now=now)

    def begin(self, now: int) -> None:
        """Let a warm process begin its work; when it has just ended, it is started from nothing."""
        process, pidfd = self.process, self.pidfd
        assert process is not None
        assert pidfd is not None
        if (hurried := self._become(self, process)) is None:
            return
        self._change(Change.HANDED_OVER)
        self._adopt(process, pidfd, now, WARM_PATIENCE_S)
        self.hurried = hurried

    def _start(self, command: list[str], *, waits: bool, now: int) -> None:
        """Start a main module. waits: for a message on its standard input."""
        self.started = now
        environment = os.environ | {VARIABLE: self.resources.encode(), "PYTHONUNBUFFERED": "1"}
        try:
            process = subprocess.Popen(
                [sys.executable, "-m", *command],
                env=environment,
                pass_fds=(*self.resources.descriptors(), *self.inherits),
                stdin=subprocess.PIPE if waits else subprocess.DEVNULL,
                stdout=subprocess.PIPE if self.plan.once else self.output,
                stderr=self.output,
                bufsize=0,
                process_group=0,  # a Ctrl-C at the terminal reaches the supervisor alone
            )
        except OSError as error:
            self._crashed(now, f"could not be started: {error.strerror}")
            return
        self._adopt(process, os.pidfd_open(process.pid), now, START_PATIENCE_S)

    def hand_over(self, child: "Child", now: int) -> bool:
        """Let this spare's process become another child; False when the spare cannot be told to."""
        process, pidfd = self.process, self.pidfd
        assert process is not None
        assert pidfd is not None
        if (hurried := self._become(child, process)) is None:
            return False
        child._adopt(process, pidfd, now, WARM_PATIENCE_S)
        child.hurried = hurried
        self.process = self.pidfd = None
        self._change(Change.HANDED_OVER)
        return True

    def _become(self, child: "Child", process: subprocess.Popen[bytes]) -> bool | None:
        """Tell a warm process which child to become. Returns whether it is hurried; None when it cannot be told."""
        assert process.stdin is not None
        hurried = hurry(process.pid)
        become = Become(child.plan.module, child.resources, hurried=hurried).encode()
        pipe = process.stdin.fileno()
        os.set_blocking(pipe, False)
        try:
            written = os.write(pipe, become) == len(become)
        except OSError:  # it has just ended
            written = False
        if not written:
            self.signal(signal.SIGKILL)
            return None
        process.stdin.close()
        process.stdin = None
        return hurried

    def has_ended(self) -> bool:
        """Has the process ended? Takes its exit status."""
        return self.process is not None and self.process.poll() is not None

    def reap(self, now: int) -> None:
        """Note the end of the process and plan what follows.

        A process that was killed because it was hung does not come closer to being disabled unless it is a real-time
        process: an ordinary one may have been slow because the machine is overloaded.
        """
        assert self.process is not None
        status, killed = self.process.returncode, self.killed
        self._release()
        if self.plan.once and status == 0:
            self._change(Change.FINISHED)
            return
        how = "was killed because it did not answer" if killed else f"ended with {_in_words(status)}"
        self._crashed(now, how, counts=self.plan.real_time or not killed)

    def re_enable(self, now: int) -> None:
        """Start a disabled process again, with its crashes forgotten."""
        self.crashes.clear()
        self.consecutive_crashes = 0
        self._change(Change.RE_ENABLED)
        self.due = self.ended = now
        self.restarts += 1

    def read_heartbeat(self) -> None:
        """Read the time of its newest heartbeat; the first one means that the process runs."""
        view = self.heartbeat.view()
        if view is not None and view.written >= self.started:
            self.last_heartbeat = view.written
            if self.state == ProcessState.STARTING and self.pid is not None:
                if self.hurried:
                    settle(self.pid)
                self._change(Change.HEARTBEAT)

    def is_hung(self, now: int, watched: int) -> bool:
        """Is the process hung? watched: since when the supervisor would have noticed a missing heartbeat [ns].

        A process with an overdue heartbeat is not hung while it computes or waits for a processor, until it has used
        ``longest_run_s`` of processor time.
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
        """When its next heartbeat is overdue [ns]; None when no heartbeat is expected."""
        if self.pid is None or self.killed or (self.plan.once and self.last_heartbeat):
            return None
        patience_s = self.plan.heartbeat_s if self.last_heartbeat else self.patience_s
        return max(self.last_heartbeat, self.started, watched) + round(patience_s * NS_PER_S)

    def kill(self) -> None:
        """End the process because it is hung."""
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
            self._release()
        self._change(Change.STOPPED)

    def _adopt(self, process: subprocess.Popen[bytes], pidfd: int, now: int, patience_s: float) -> None:
        """Begin a new life with a process."""
        self._change(Change.STARTED)
        self.process, self.pidfd = process, pidfd
        self.started, self.patience_s = now, patience_s
        self.last_heartbeat, self.silence, self.killed, self.hurried = 0, None, False, False

    def _crashed(self, now: int, how: str, *, counts: bool = True) -> None:
        """Decide what follows a crash: a start now, a start later, or none. counts: towards disabling the process."""
        self.crashes = [crash for crash in self.crashes if now - crash < CRASH_WINDOW_S * NS_PER_S]
        if counts:
            self.crashes.append(now)
        self.ended, self.detail = now, how
        if self.plan.once or len(self.crashes) >= CRASHES_TO_DISABLE:
            if not self.plan.once:
                self.detail = f"{len(self.crashes)} crashes within a minute; the last time it {how}"
            self._change(Change.GIVEN_UP)
            return
        self.consecutive_crashes = self.consecutive_crashes + 1 if now - self.started < STEADY_S * NS_PER_S else 0
        delay_s = FIRST_DELAY_S * 2.0 ** (self.consecutive_crashes - 2) if self.consecutive_crashes > 1 else 0.0
        self.due = now + int(min(delay_s, MAX_DELAY_S) * NS_PER_S)
        self._change(Change.CRASHED)
        self.restarts += 1

    def _change(self, change: Change) -> None:
        self.state = next_state(self.state, change)

    def _release(self) -> None:
        """Close the descriptors of a process that has ended."""
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
