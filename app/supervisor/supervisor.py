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

from app.supervisor.child import SETTLED, Child
from app.supervisor.control import Answer, ControlSocket
from app.supervisor.plan import ChildPlan, ServicePlan
from app.supervisor.priorities import go_first
from app.supervisor.spares import Spares, spare_plans
from vision_core.clock import NS_PER_S
from vision_core.rtdb.slots import SlotReader
from vision_core.rtdb.store import Store, create_block
from vision_core.scheduling.attachment import HEARTBEAT, ChildResources, monotonic, name_process

TICK_S = 0.1
MIN_TICK_S = 0.02
LATE_S = 0.1
"""A turn that comes so much later than was planned: the machine stood still, not the children."""
PUBLISH_EVERY_S = 0.5
STOP_PATIENCE_S = 1.5
"""Children that have not ended by then after SIGTERM are killed; the service stops within 3 s."""


class Supervisor:
    """Starts the plan's processes, keeps them alive, and ends them."""

    def __init__(self, plan: ServicePlan, tell: Callable[[str], None], progress: Callable[[str], None]) -> None:
        """tell: one line of news; progress: how far the process that runs once is, and "" when it is done.

        Raises ServiceError when the control socket's name is taken.
        """
        self._plan = plan
        self._tell = tell
        self._progress = progress
        self._control = ControlSocket(plan.control, self._answer)
        self._block = create_block(plan.records)
        self._to_look_at = os.open(f"/proc/self/fd/{self._block}", os.O_RDONLY | os.O_CLOEXEC)
        self._store = Store(plan.records, self._block)
        for name, value in plan.initial.items():
            self._store.writer(name).write(value, monotonic(), monotonic())
        self._events = {child.name: os.eventfd(0, os.EFD_NONBLOCK) for child in plan.children if child.wakes}
        self._processes = self._store.writer("processes")
        self.children = [Child(child, self._handed(child), self._heartbeat(child)) for child in plan.children]
        self.spares = Spares([self._spare(spare) for spare in spare_plans(plan)])
        self._everybody = (*self.children, *self.spares.all)
        self._woken, self._wake = socket.socketpair()
        self._woken.setblocking(False)
        self._wake.setblocking(False)
        self._stopping = False
        self._failed = False
        self._complete = False
        self._turned = self._watched = time.monotonic_ns()
        """The newest turn, and since when turns came in time [ns]."""
        self._told: tuple[bytes, int] = b"", 0
        """The newest table of processes, and when it was written [ns]."""

    def run(self) -> int:
        """Run until SIGINT or SIGTERM; returns the exit status."""
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
            self._tell("stopped")
            for number, handler in previous.items():
                signal.signal(number, handler)
        return 2 if self._failed else 0

    def _turn(self) -> None:
        """Wait for something to happen, and do what follows from it."""
        tick_s = self._tick_s()
        self._wait(tick_s)
        now = time.monotonic_ns()
        if now - self._turned > (tick_s + LATE_S) * NS_PER_S:
            self._watched = now
        self._turned = now
        for child in self._everybody:
            self._look_after(child, now)
        for child in self.children:
            if child.state == "restarting" and now >= child.due:
                self._replace(child, now)
        if not self._complete and all(child.state in SETTLED for child in self.children):
            self._complete = True
            self._tell("ready")
        if self._complete:
            self.spares.refill(self.children, now)
        self._control.hang_up(now)
        self._publish(now)

    def _tick_s(self) -> float:
        """How long nothing needs a look [s]: until a silence is too long, or a replacement is due."""
        looks = [overdue for child in self._everybody if (overdue := child.overdue_at(self._watched)) is not None]
        looks += [child.due for child in self.children if child.state == "restarting"]
        left_s = (min(looks) - self._turned) / NS_PER_S if looks else TICK_S
        return min(max(left_s, MIN_TICK_S), TICK_S)

    def _wait(self, tick_s: float) -> None:
        poller = select.poll()
        poller.register(self._woken, select.POLLIN)
        for descriptor in self._control.descriptors():
            poller.register(descriptor, select.POLLIN)
        for child in self._everybody:
            if child.pidfd is not None:
                poller.register(child.pidfd, select.POLLIN)
            if child.process is not None and child.process.stdout is not None:
                poller.register(child.process.stdout, select.POLLIN)
        for descriptor, _event in poller.poll(tick_s * 1e3):
            if descriptor == self._woken.fileno():
                with contextlib.suppress(BlockingIOError):
                    self._woken.recv(64)
            self._control.serve(descriptor, time.monotonic_ns())
            self._hear_progress(descriptor)

    def _hear_progress(self, descriptor: int) -> None:
        for child in self.children:
            pipe = child.process.stdout if child.process is not None else None
            if pipe is not None and pipe.fileno() == descriptor:
                text = os.read(descriptor, 4096).decode(errors="replace").strip()
                if text:
                    child.detail = text.splitlines()[-1]
                    self._progress(child.detail)

    def _look_after(self, child: Child, now: int) -> None:
        """Take note of an end or a first beat, and end what hangs."""
        if child.has_ended():
            child.reap(now)
            if child.plan.once:
                self._compiled(child, now)
            else:
                self._tell(f"{child.plan.name} {child.detail}: {child.state}")
        elif child.process is not None:
            was_starting = child.state == "starting"
            child.note_heartbeat()
            if was_starting and child.state == "running" and child.ended and child in self.children:
                self._tell(
                    f"{child.plan.name} runs again after {(child.last_heartbeat - child.ended) / NS_PER_S:.2f} s"
                )
            if child.is_hung(now, self._watched):
                self._tell(f"{child.plan.name} does not answer and is killed")
                child.kill()

    def _stop_without_compiler(self, child: Child) -> None:
        """Nothing can follow what runs once, when that could not even be started."""
        if child.plan.once and child.process is None:
            self._compiled(child, time.monotonic_ns())

    def _replace(self, child: Child, now: int) -> None:
        """Start a child again: with a warm spare if there is one."""
        spare = self.spares.take_place(child, now)
        if spare is None:
            child.start(now)
        else:
            self._tell(f"{spare.plan.name} takes the place of {child.plan.name}")

    def _compiled(self, child: Child, now: int) -> None:
        self._progress("")
        if child.state != "done":
            self._tell(f"{child.plan.name} {child.detail}: the service cannot start")
            self._failed = self._stopping = True
            return
        for other in self.children:
            if other.plan.after_compile:
                other.start(now)

    def _publish(self, now: int) -> None:
        """Write the table of processes when it has changed, and now and then as a sign of life."""
        table = json.dumps({"processes": [child.row() for child in self._everybody]}).encode()
        before, written = self._told
        if table != before or now - written > PUBLISH_EVERY_S * NS_PER_S:
            self._told = table, now
            self._processes.write(table, monotonic(), monotonic())

    def _answer(self, request: object) -> Answer:
        """What to say to somebody on the control socket."""
        match request:
            case {"do": "attach"}:
                records = [asdict(spec) for spec in self._plan.records]
                told = {"boot": self._plan.boot, "records": records, "control": self._plan.control}
                return told, (self._to_look_at,)
            case {"do": "restart", "name": str(name)}:
                return self._restart(name), ()
        return {"error": "no such request", "accepted": '{"do": "attach"}, {"do": "restart", "name": ...}'}, ()

    def _restart(self, name: str) -> dict[str, Any]:
        """Try a disabled process again."""
        disabled = [child for child in self._everybody if child.state == "disabled" and not child.plan.once]
        for child in disabled:
            if child.plan.name == name:
                child.re_enable(time.monotonic_ns())
                self._tell(f"{name} is tried again")
                return {"restarted": name}
        accepted = ", ".join(child.plan.name for child in disabled) or "nothing now, no process is disabled"
        return {"error": "it is no disabled process", "accepted": accepted}

    def _shut_down(self) -> None:
        """End every child, then let go of memory, events and sockets."""
        self._control.close()
        for child in self._everybody:
            child.signal(signal.SIGTERM)
        deadline = time.monotonic() + STOP_PATIENCE_S
        while time.monotonic() < deadline and not all(
            child.process is None or child.has_ended() for child in self._everybody
        ):
            time.sleep(0.01)
        for child in self._everybody:
            child.stop_for_good()
        self._store.close()
        for descriptor in (self._block, self._to_look_at, *self._events.values()):
            os.close(descriptor)
        for owned in (self._woken, self._wake, *self._plan.sockets.values()):
            owned.close()

    def _stop(self, _number: int, _frame: object) -> None:
        self._stopping = True

    def _handed(self, plan: ChildPlan) -> ChildResources:
        """What a child gets hold of."""
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

    def _spare(self, plan: ChildPlan) -> Child:
        """A spare may become any child, so it gets everything, and the names of all modules to import."""
        modules = dict.fromkeys(child.module for child in self._plan.children if child.spared)
        sockets = [self._plan.sockets[name].fileno() for child in self._plan.children for name in child.sockets]
        return Child(
            plan,
            self._handed(plan),
            self._heartbeat(plan),
            arguments=tuple(modules),
            inherits=(*self._events.values(), *sockets),
            takes_orders=True,
        )
