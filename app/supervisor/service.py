"""The supervisor's loop."""

import contextlib
import json
import os
import select
import signal
import socket
import time
from collections.abc import Callable

from app.supervisor.child import Child
from app.supervisor.plan import ServicePlan
from vision_core.clock import NS_PER_S
from vision_core.rtdb.attachment import HandDown, monotonic
from vision_core.rtdb.store import Store, create_block

TICK_S = 0.2
LONGEST_DETAIL = 200
STOP_PATIENCE_S = 1.5
"""Children that have not ended by then after SIGTERM are killed; the service stops within 3 s."""


class Supervisor:
    """Starts the plan's processes, keeps them alive, and ends them."""

    def __init__(self, plan: ServicePlan, tell: Callable[[str], None], progress: Callable[[str], None]) -> None:
        """tell: one line of news; progress: how far the process that runs once is, and "" when it is done."""
        self._plan = plan
        self._tell = tell
        self._progress = progress
        self._block = create_block(plan.records)
        self._store = Store(plan.records, self._block)
        for name, value in plan.initial.items():
            self._store.writer(name).write(value, monotonic(), monotonic())
        self._events = {child.name: os.eventfd(0, os.EFD_NONBLOCK) for child in plan.children if child.trigger}
        self._processes = self._store.writer("processes")
        self.children = [self._child(index) for index in range(len(plan.children))]
        self._woken, self._wake = socket.socketpair()
        self._woken.setblocking(False)
        self._wake.setblocking(False)
        self._stopping = False
        self._failed = False
        self._complete = False

    def run(self) -> int:
        """Run until SIGINT or SIGTERM; returns the exit status."""
        previous = {number: signal.signal(number, self._stop) for number in (signal.SIGINT, signal.SIGTERM)}
        wakeup = signal.set_wakeup_fd(self._wake.fileno(), warn_on_full_buffer=False)
        try:
            for child in self.children:
                if not child.plan.after_compile:
                    child.start(time.monotonic_ns())
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
        self._wait()
        now = time.monotonic_ns()
        for child in self.children:
            before = child.state
            self._look_after(child, now)
            if child.state != before:
                self._report(child)
        if not self._complete and all(child.state in ("running", "done") for child in self.children):
            self._complete = True
            self._tell("ready")
        self._publish()

    def _wait(self) -> None:
        poller = select.poll()
        poller.register(self._woken, select.POLLIN)
        for child in self.children:
            if child.pidfd is not None:
                poller.register(child.pidfd, select.POLLIN)
            if child.process is not None and child.process.stdout is not None:
                poller.register(child.process.stdout, select.POLLIN)
        for descriptor, _event in poller.poll(TICK_S * 1e3):
            if descriptor == self._woken.fileno():
                with contextlib.suppress(BlockingIOError):
                    self._woken.recv(64)
            for child in self.children:
                pipe = child.process.stdout if child.process is not None else None
                if pipe is not None and pipe.fileno() == descriptor:
                    text = os.read(descriptor, 4096).decode(errors="replace").strip()
                    if text:
                        child.detail = text.splitlines()[-1]
                        self._progress(child.detail)

    def _look_after(self, child: Child, now: int) -> None:
        if child.has_ended():
            child.bury(now)
            if child.plan.once:
                self._compiled(child, now)
        elif child.process is not None and child.is_silent(now):
            self._tell(f"{child.plan.name} does not answer and is killed")
            child.signal(signal.SIGKILL)
        if child.state == "restarting" and now >= child.due:
            child.start(now)

    def _compiled(self, child: Child, now: int) -> None:
        self._progress("")
        if child.state != "done":
            self._tell(f"{child.plan.name} {child.detail}: the service cannot start")
            self._failed = self._stopping = True
            return
        for other in self.children:
            if other.plan.after_compile:
                other.start(now)

    def _report(self, child: Child) -> None:
        if child.state in ("restarting", "disabled") and not child.plan.once:
            self._tell(f"{child.plan.name} {child.detail}: {child.state}")
        elif child.state == "running" and child.restarts:
            self._tell(f"{child.plan.name} runs again after {(time.monotonic_ns() - child.ends[-1]) / NS_PER_S:.1f} s")

    def _publish(self) -> None:
        table = {
            "processes": [
                {
                    "name": child.plan.name,
                    "pid": child.pid,
                    "state": child.state,
                    "restarts": child.restarts,
                    "detail": child.detail[:LONGEST_DETAIL],
                }
                for child in self.children
            ]
        }
        now = monotonic()
        self._processes.write(json.dumps(table).encode(), now, now)

    def _shut_down(self) -> None:
        """End every child, then let go of memory, events and sockets."""
        for child in self.children:
            child.signal(signal.SIGTERM)
        deadline = time.monotonic() + STOP_PATIENCE_S
        while time.monotonic() < deadline and not all(
            child.process is None or child.has_ended() for child in self.children
        ):
            time.sleep(0.01)
        for child in self.children:
            child.stop_for_good()
        self._store.close()
        for descriptor in (self._block, *self._events.values()):
            os.close(descriptor)
        for owned in (self._woken, self._wake, *self._plan.sockets.values()):
            owned.close()

    def _stop(self, _number: int, _frame: object) -> None:
        self._stopping = True

    def _child(self, index: int) -> Child:
        plan = self._plan.children[index]
        notify = {
            record: tuple(self._events[other.name] for other in self._plan.children if other.trigger == record)
            for record in plan.writes
        }
        handed = HandDown(
            process=plan.name,
            supervisor=os.getpid(),
            boot=self._plan.boot,
            block=self._block,
            records=self._plan.records,
            wake=self._events.get(plan.name),
            notify={record: events for record, events in notify.items() if events},
            sockets={name: self._plan.sockets[name].fileno() for name in plan.sockets},
        )
        return Child(plan, handed, self._store.reader(f"task/{plan.name}"))
