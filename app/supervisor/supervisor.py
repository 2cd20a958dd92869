"""The supervisor's loop."""

import contextlib
import json
import os
import select
import signal
import socket
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict
from types import MappingProxyType
from typing import Any

from app.supervisor.child import Child
from app.supervisor.control import Answer, ControlSocket
from app.supervisor.family import Family
from app.supervisor.own_output import OwnOutput, wait_for_end
from app.supervisor.plan import ServicePlan
from app.supervisor.priorities import go_first
from app.supervisor.restart import CARRIED, Restart
from vision_core.clock import NS_PER_S
from vision_core.rtdb.process_state import SETTLED, ProcessState, RestartState
from vision_core.scheduling.attachment import monotonic, name_process

TICK_S = 0.1
MIN_TICK_S = 0.02
LATE_S = 0.1
"""A turn of the loop that is later than this means that the whole machine stood still, not the children."""
PUBLISH_EVERY_S = 0.5
REQUEST = "restart_request"
"""Record by which the page asks for a restart of the service."""
STOP_PATIENCE_S = 1.5
"""Time that children have to end after SIGTERM before they are killed; the service stops within 3 s."""


class Supervisor:
    """Starts the processes of a plan, starts them again when they end, and stops them."""

    def __init__(self, plan: ServicePlan, log: Callable[[str], None], progress: Callable[[str], None] | None) -> None:
        """log: takes one line; progress: takes the progress of the process that runs once, "" when it is done; None:
        it is logged.
        """
        self._plan = plan
        self._progress = progress or self._log_progress
        self._family = Family(plan)
        self._store = self._family.store
        self.children, self.spares, self._all = self._family.children, self._family.spares, self._family.all
        self._control: ControlSocket | None = None
        self._processes = self._store.writer("processes")
        self._own_output = OwnOutput(self.children, plan.sockets, log)
        self._restart = Restart(plan.check, self.say)
        self._request = self._store.reader(REQUEST) if REQUEST in self._store.specs else None
        self._woken, self._wake = socket.socketpair()
        self._woken.setblocking(False)
        self._wake.setblocking(False)
        self._requests = 0
        """How many requests of a restart were taken note of."""
        self._stopping = False
        self._failed = False
        self._complete = False
        self._last_turn = self._on_time_since = time.monotonic_ns()
        """The last turn of the loop, and since when no turn was late [ns]."""
        self._published: tuple[bytes, int] = b"", 0
        """The newest table of processes, and when it was written [ns]."""

    @property
    def is_restarting(self) -> bool:
        """Is the service to be restarted? Then ``run`` has returned, or returns soon."""
        return self._restart.state is RestartState.RESTARTING

    @property
    def is_stopping(self) -> bool:
        """Did SIGINT, SIGTERM or a failure end ``run``?"""
        return self._stopping

    def say(self, line: str) -> None:
        """Print a line, and keep it in the log."""
        self._own_output.say(line)

    def refuse_restart(self, why: str) -> None:
        """Go on as it is. why: in words."""
        self._restart.refuse(why)

    def tell_restart(self, progress: str) -> None:
        """Say how far a restart is."""
        self._restart.detail = progress

    def warm_up(self) -> tuple[int, int]:
        """Let the next child load what it needs, without beginning; another supervisor's children do their work yet.

        To be called again and again: one loads at a time, so that it delays the others little. Returns how many have
        loaded or given up, and how many there are.
        """
        now = time.monotonic_ns()
        warmed = [child for child in self.children if child.plan.spared]
        for child in warmed:
            self._check(child, now)
        if not any(child.state is ProcessState.STARTING for child in warmed):
            for child in warmed:
                if child.state is ProcessState.WAITING:
                    child.start_warm(self._plan.spare_module, now)
                    break
        done = sum(child.state not in (ProcessState.WAITING, ProcessState.STARTING) for child in warmed)
        return done, len(warmed)

    def start(self, carried: Mapping[str, bytes] = MappingProxyType({})) -> None:
        """Start the children, the warm ones among them. carried: what ``stop`` of an earlier supervisor returned.

        Raises ServiceError when the control socket's name is taken.
        """
        self._control = ControlSocket(self._plan.control, self._answer)
        self._family.write(carried)
        name_process("pslv:supervisor")
        go_first()
        for child in self.children:
            if child.is_warm:
                child.begin(time.monotonic_ns())
        self._start_waiting(time.monotonic_ns())

    def run(self, is_over: Callable[[], bool]) -> None:
        """Keep the children running until something is over, or SIGINT or SIGTERM comes."""
        previous = {number: signal.signal(number, self._stop) for number in (signal.SIGINT, signal.SIGTERM)}
        wakeup = signal.set_wakeup_fd(self._wake.fileno(), warn_on_full_buffer=False)
        try:
            while not self._stopping and not is_over():
                self._turn()
        finally:
            signal.set_wakeup_fd(wakeup)
            for number, handler in previous.items():
                signal.signal(number, handler)

    def stop(self) -> dict[str, bytes]:
        """End every child and give everything back. Returns the records with which a restarted service goes on."""
        if self._control is not None:
            self._control.close()
        others = [child for child in self._all if child is not self._own_output.reader]
        for child in others:
            child.signal(signal.SIGTERM)
        wait_for_end(others, STOP_PATIENCE_S)
        for child in others:
            child.stop_for_good()
        self._restart.close()
        if not self.is_restarting or self._stopping:
            self.say("stopped")
        self._own_output.end()
        readings = {name: self._store.reader(name).read(monotonic()) for name in CARRIED if name in self._store.specs}
        self._family.close()
        self._woken.close()
        self._wake.close()
        return {name: reading.value for name, reading in readings.items() if reading}

    @property
    def exit_status(self) -> int:
        """Of the service, when it was stopped."""
        return 2 if self._failed else 0

    def _turn(self) -> None:
        """Wait for an event or the next check, and handle it."""
        tick_s = self._tick_s()
        self._wait(tick_s)
        now = time.monotonic_ns()
        if now - self._last_turn > (tick_s + LATE_S) * NS_PER_S:
            self._on_time_since = now
        self._last_turn = now
        for child in self._all:
            self._check(child, now)
        self._start_waiting(now)
        for child in self.children:
            if child.state == ProcessState.RESTARTING and now >= child.due:
                self._replace(child, now)
        if not self._complete and all(child.state in SETTLED for child in self.children):
            self._complete = True
            running = sum(child.state is ProcessState.RUNNING for child in self.children if not child.plan.once)
            self.say(f"{running} of {sum(not child.plan.once for child in self.children)} processes run")
        if self._complete:
            self.spares.refill(self.children, now)
        assert self._control is not None
        self._control.close_slow(now)
        self._follow_restart()
        self._publish(now)

    def _follow_restart(self) -> None:
        """Take note of a request to restart the service, and of what its check found."""
        if self._request is not None and self._request.sequence != self._requests:
            self._requests = self._request.sequence
            reading = self._request.read(monotonic())
            self._restart.request(json.loads(reading.value)["who"] if reading else "somebody")
        self._restart.follow(is_complete=self._complete)

    def _tick_s(self) -> float:
        """Time until the next check [s]: until a heartbeat is overdue or a start is due."""
        checks = [overdue for child in self._all if (overdue := child.overdue_at(self._on_time_since)) is not None]
        checks += [child.due for child in self.children if child.state == ProcessState.RESTARTING]
        left_s = (min(checks) - self._last_turn) / NS_PER_S if checks else TICK_S
        return min(max(left_s, MIN_TICK_S), TICK_S)

    def _wait(self, tick_s: float) -> None:
        poller = select.poll()
        poller.register(self._woken, select.POLLIN)
        assert self._control is not None
        for descriptor in self._control.descriptors(time.monotonic_ns()):
            poller.register(descriptor, select.POLLIN)
        for child in self._all:
            if child.pidfd is not None:
                poller.register(child.pidfd, select.POLLIN)
            if child.process is not None and child.process.stdout is not None:
                poller.register(child.process.stdout, select.POLLIN)
        for descriptor, _event in poller.poll(tick_s * 1e3):
            if descriptor == self._woken.fileno():
                with contextlib.suppress(BlockingIOError):
                    self._woken.recv(64)
            self._control.serve(descriptor, time.monotonic_ns())
            self._read_progress(descriptor)

    def _read_progress(self, descriptor: int) -> None:
        for child in self.children:
            pipe = child.process.stdout if child.process is not None else None
            if pipe is not None and pipe.fileno() == descriptor:
                text = os.read(descriptor, 4096).decode(errors="replace").strip()
                if text:
                    child.detail = text.splitlines()[-1]
                    self._progress(child.detail)

    def _log_progress(self, text: str) -> None:
        if text:
            self.say(f"compiling: {text}")

    def _check(self, child: Child, now: int) -> None:
        """Note the end or the first heartbeat of a process, and kill it when it is hung."""
        if child.has_ended():
            if child.process is not None and child.process.stdout is not None:
                self._read_progress(child.process.stdout.fileno())  # its last line, written just before it ended
            child.reap(now)
            if child.plan.once:
                self._ran_once(child)
            else:
                self.say(f"{child.plan.title} {child.detail}: {_consequence(child)}")
        elif child.process is not None:
            was_starting = child.state == ProcessState.STARTING
            child.read_heartbeat()
            if was_starting and child.state == ProcessState.RUNNING and child.ended and child in self.children:
                self.say(f"{child.plan.title} runs again after {(child.last_heartbeat - child.ended) / NS_PER_S:.2f} s")
            if child.is_hung(now, self._on_time_since):
                self.say(f"{child.plan.title} does not answer and is killed")
                child.kill()

    def _start_waiting(self, now: int) -> None:
        """Start the children that wait for nothing any more. One that runs once and cannot be started has failed."""
        holding = {child.plan.name for child in self.children if child.holds_others}
        for child in self.children:
            if child.state is ProcessState.WAITING and child.plan.after not in holding and not self._failed:
                child.start(now)
                if child.plan.once and child.process is None:
                    self._ran_once(child)

    def _replace(self, child: Child, now: int) -> None:
        """Start a child again: from a warm spare if one is ready."""
        spare = self.spares.take_place(child, now)
        if spare is None:
            child.start(now)
        else:
            self.say(f"{spare.plan.name} takes the place of {child.plan.title}")

    def _ran_once(self, child: Child) -> None:
        """Note the end of a process that runs once; end the service when it failed and must not fail."""
        self._progress("")
        if child.state != ProcessState.DONE:
            consequence = (
                "those that wait for it start without it" if child.plan.may_fail else "the service cannot start"
            )
            self.say(f"{child.plan.name} {child.detail}: {consequence}")
            if not child.plan.may_fail:
                self._failed = self._stopping = True

    def _publish(self, now: int) -> None:
        """Write the table of processes when it has changed, and every PUBLISH_EVERY_S as the supervisor's heartbeat."""
        rows = [child.row() for child in self._all]
        table = json.dumps({"processes": rows, "restart": self._restart.row()}).encode()
        before, written = self._published
        if table != before or now - written > PUBLISH_EVERY_S * NS_PER_S:
            self._published = table, now
            self._processes.write(table, monotonic(), monotonic())

    def _answer(self, request: object) -> Answer:
        """The answer to a request at the control socket."""
        match request:
            case {"do": "attach"}:
                records = [asdict(spec) for spec in self._plan.records]
                answer = {"boot": self._plan.boot, "records": records, "control": self._plan.control}
                return answer, (self._family.read_only_block,)
            case {"do": "restart", "name": str(name)}:
                return self._start_again(name), ()
            case {"do": "restart"}:
                self._restart.request("the command line")
                self._publish(time.monotonic_ns())
                return {"restart": self._restart.row()}, ()
        return {
            "error": "no such request",
            "accepted": '{"do": "attach"}, {"do": "restart"}, with "name" one process',
        }, ()

    def _start_again(self, name: str) -> dict[str, Any]:
        """Start a disabled process again."""
        disabled = [child for child in self._all if child.state == ProcessState.DISABLED and not child.plan.once]
        for child in disabled:
            if child.plan.name == name:
                child.re_enable(time.monotonic_ns())
                self.say(f"{child.plan.title} is started again on request")
                return {"restarted": name}
        accepted = ", ".join(child.plan.name for child in disabled) or "none: no process is disabled"
        return {"error": "it is not disabled", "accepted": accepted}

    def _stop(self, _number: int, _frame: object) -> None:
        self._stopping = True


def _consequence(child: Child) -> str:
    """What follows from the end of a process, for the log."""
    if child.state == ProcessState.DISABLED:
        return f"it stays off; pslv restart {child.plan.name} starts it again"
    delay_s = (child.due - child.ended) / NS_PER_S
    return f"it is started again in {delay_s:g} s" if delay_s else "it is started again"
