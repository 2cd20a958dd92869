"""The supervisor's loop."""

import contextlib
import json
import os
import select
import signal
import socket
import time
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from app.supervisor.child import Child
from app.supervisor.control import Answer, ControlSocket
from app.supervisor.own_output import OwnOutput, wait_for_end
from app.supervisor.plan import LOG, OUTPUT, ChildPlan, ServicePlan
from app.supervisor.priorities import go_first
from app.supervisor.spares import Spares, spare_plans
from vision_core.clock import NS_PER_S
from vision_core.rtdb.process_state import SETTLED, ProcessState
from vision_core.rtdb.slots import SlotReader
from vision_core.rtdb.store import Store, create_block
from vision_core.scheduling.attachment import HEARTBEAT, ChildResources, monotonic, name_process

TICK_S = 0.1
MIN_TICK_S = 0.02
LATE_S = 0.1
"""A turn of the loop that is later than this means that the whole machine stood still, not the children."""
PUBLISH_EVERY_S = 0.5
STOP_PATIENCE_S = 1.5
"""Time that children have to end after SIGTERM before they are killed; the service stops within 3 s."""


class Supervisor:
    """Starts the processes of a plan, starts them again when they end, and stops them."""

    def __init__(self, plan: ServicePlan, log: Callable[[str], None], progress: Callable[[str], None] | None) -> None:
        """log: takes one line; progress: takes the progress of the process that runs once, "" when it is done; None:
        it is logged.

        Raises ServiceError when the control socket's name is taken.
        """
        self._plan = plan
        self._progress = progress or self._log_progress
        self._control = ControlSocket(plan.control, self._answer)
        self._block = create_block(plan.records)
        self._read_only_block = os.open(f"/proc/self/fd/{self._block}", os.O_RDONLY | os.O_CLOEXEC)
        self._store = Store(plan.records, self._block)
        for name, value in plan.initial.items():
            self._store.writer(name).write(value, monotonic(), monotonic())
        self._events = {child.name: os.eventfd(0, os.EFD_NONBLOCK) for child in plan.children if child.wakes}
        self._processes = self._store.writer("processes")
        self.children = [
            Child(child, self._resources(child), self._heartbeat(child), output=self._output(child))
            for child in plan.children
        ]
        self._own_output = OwnOutput(self.children, plan.sockets, log)
        self._log = self._own_output.say
        self.spares = Spares([self._spare(spare) for spare in spare_plans(plan)])
        self._all = (*self.children, *self.spares.all)
        self._woken, self._wake = socket.socketpair()
        self._woken.setblocking(False)
        self._wake.setblocking(False)
        self._stopping = False
        self._failed = False
        self._complete = False
        self._last_turn = self._on_time_since = time.monotonic_ns()
        """The last turn of the loop, and since when no turn was late [ns]."""
        self._published: tuple[bytes, int] = b"", 0
        """The newest table of processes, and when it was written [ns]."""

    def run(self) -> int:
        """Run until SIGINT or SIGTERM. Returns the exit status of the service."""
        previous = {number: signal.signal(number, self._stop) for number in (signal.SIGINT, signal.SIGTERM)}
        wakeup = signal.set_wakeup_fd(self._wake.fileno(), warn_on_full_buffer=False)
        try:
            name_process("pslv:supervisor")
            go_first()
            for child in self.children:
                if not child.plan.after_compile:
                    child.start(time.monotonic_ns())
                    self._stop_without_compiler(child)
            while not self._stopping:
                self._turn()
        finally:
            signal.set_wakeup_fd(wakeup)
            self._shut_down()
            for number, handler in previous.items():
                signal.signal(number, handler)
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
        for child in self.children:
            if child.state == ProcessState.RESTARTING and now >= child.due:
                self._replace(child, now)
        if not self._complete and all(child.state in SETTLED for child in self.children):
            self._complete = True
            running = sum(child.state is ProcessState.RUNNING for child in self.children if not child.plan.once)
            self._log(f"{running} of {sum(not child.plan.once for child in self.children)} processes run")
        if self._complete:
            self.spares.refill(self.children, now)
        self._control.close_slow(now)
        self._publish(now)

    def _tick_s(self) -> float:
        """Time until the next check [s]: until a heartbeat is overdue or a start is due."""
        checks = [overdue for child in self._all if (overdue := child.overdue_at(self._on_time_since)) is not None]
        checks += [child.due for child in self.children if child.state == ProcessState.RESTARTING]
        left_s = (min(checks) - self._last_turn) / NS_PER_S if checks else TICK_S
        return min(max(left_s, MIN_TICK_S), TICK_S)

    def _wait(self, tick_s: float) -> None:
        poller = select.poll()
        poller.register(self._woken, select.POLLIN)
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
            self._log(f"compiling: {text}")

    def _check(self, child: Child, now: int) -> None:
        """Note the end or the first heartbeat of a process, and kill it when it is hung."""
        if child.has_ended():
            if child.process is not None and child.process.stdout is not None:
                self._read_progress(child.process.stdout.fileno())  # its last line, written just before it ended
            child.reap(now)
            if child.plan.once:
                self._compiled(child, now)
            else:
                self._log(f"{child.plan.title} {child.detail}: {_consequence(child)}")
        elif child.process is not None:
            was_starting = child.state == ProcessState.STARTING
            child.read_heartbeat()
            if was_starting and child.state == ProcessState.RUNNING and child.ended and child in self.children:
                self._log(
                    f"{child.plan.title} runs again after {(child.last_heartbeat - child.ended) / NS_PER_S:.2f} s"
                )
            if child.is_hung(now, self._on_time_since):
                self._log(f"{child.plan.title} does not answer and is killed")
                child.kill()

    def _stop_without_compiler(self, child: Child) -> None:
        """End the service when the process that runs once could not be started."""
        if child.plan.once and child.process is None:
            self._compiled(child, time.monotonic_ns())

    def _replace(self, child: Child, now: int) -> None:
        """Start a child again: from a warm spare if one is ready."""
        spare = self.spares.take_place(child, now)
        if spare is None:
            child.start(now)
        else:
            self._log(f"{spare.plan.name} takes the place of {child.plan.title}")

    def _compiled(self, child: Child, now: int) -> None:
        """Start the other processes when the one that runs once has ended well; end the service when it failed."""
        self._progress("")
        if child.state != ProcessState.DONE:
            self._log(f"{child.plan.name} {child.detail}: the service cannot start")
            self._failed = self._stopping = True
            return
        for other in self.children:
            if other.plan.after_compile:
                other.start(now)

    def _publish(self, now: int) -> None:
        """Write the table of processes when it has changed, and every PUBLISH_EVERY_S as the supervisor's heartbeat."""
        table = json.dumps({"processes": [child.row() for child in self._all]}).encode()
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
                return answer, (self._read_only_block,)
            case {"do": "restart", "name": str(name)}:
                return self._restart(name), ()
        return {"error": "no such request", "accepted": '{"do": "attach"}, {"do": "restart", "name": ...}'}, ()

    def _restart(self, name: str) -> dict[str, Any]:
        """Start a disabled process again."""
        disabled = [child for child in self._all if child.state == ProcessState.DISABLED and not child.plan.once]
        for child in disabled:
            if child.plan.name == name:
                child.re_enable(time.monotonic_ns())
                self._log(f"{child.plan.title} is started again on request")
                return {"restarted": name}
        accepted = ", ".join(child.plan.name for child in disabled) or "none: no process is disabled"
        return {"error": "it is not disabled", "accepted": accepted}

    def _shut_down(self) -> None:
        """End every child, then close memory, events and sockets."""
        self._control.close()
        others = [child for child in self._all if child is not self._own_output.reader]
        for child in others:
            child.signal(signal.SIGTERM)
        wait_for_end(others, STOP_PATIENCE_S)
        for child in others:
            child.stop_for_good()
        self._log("stopped")
        self._own_output.end()
        self._store.close()
        for descriptor in (self._block, self._read_only_block, *self._events.values()):
            os.close(descriptor)
        for owned in (self._woken, self._wake, *self._plan.sockets.values()):
            owned.close()

    def _stop(self, _number: int, _frame: object) -> None:
        self._stopping = True

    def _resources(self, plan: ChildPlan) -> ChildResources:
        """What a child is given."""
        notify = {
            record: tuple(self._events[other.name] for other in self._plan.children if record in other.wakes)
            for record in plan.writes
        }
        return ChildResources(
            process=plan.name,
            supervisor=os.getpid(),
            boot=self._plan.boot,
            block=self._block,
            records=self._plan.records,
            wake=self._events.get(plan.name),
            notify={record: events for record, events in notify.items() if events},
            sockets={name: self._plan.sockets[name].fileno() for name in plan.sockets},
        )

    def _heartbeat(self, plan: ChildPlan) -> SlotReader:
        return self._store.reader(f"{HEARTBEAT}/{plan.name}")

    def _output(self, plan: ChildPlan) -> int | None:
        """Where a child prints."""
        output = self._plan.sockets.get(OUTPUT)
        return None if output is None or LOG in plan.sockets else output.fileno()

    def _spare(self, plan: ChildPlan) -> Child:
        """A spare may become any child: it inherits every descriptor, and imports the main module of every child."""
        modules = dict.fromkeys(child.module for child in self._plan.children if child.spared)
        sockets = [self._plan.sockets[name].fileno() for child in self._plan.children for name in child.sockets]
        return Child(
            plan,
            self._resources(plan),
            self._heartbeat(plan),
            arguments=tuple(modules),
            inherits=(*self._events.values(), *sockets),
            output=self._output(plan),
            is_spare=True,
        )


def _consequence(child: Child) -> str:
    """What follows from the end of a process, for the log."""
    if child.state == ProcessState.DISABLED:
        return f"it stays off; pslv restart {child.plan.name} starts it again"
    delay_s = (child.due - child.ended) / NS_PER_S
    return f"it is started again in {delay_s:g} s" if delay_s else "it is started again"
