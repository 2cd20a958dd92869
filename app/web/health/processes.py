"""Causes of worse service: processes that do not run, and tasks that are switched off."""

from collections.abc import Iterator, Sequence

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Cause, Subject
from app.web.health.readiness import (
    COMPILER,
    COMPILER_OF_OTHERS,
    needed_processes,
    process_advice,
    process_of,
    process_state,
)
from vision_core.rtdb import records
from vision_core.rtdb.infos import ProcessInfo
from vision_core.rtdb.process_state import ProcessState

RESTART_HOLD_S = 1.0
"""A spare process takes the place of a crashed one within 0.3 s. A process that is still not back after this time, or
crashes again before ``hysteresis.RELEASE_S`` has passed, is worth a message."""


def process_degradations(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """Processes that are disabled or crash again and again, beside those without which nothing is served."""
    ignored = needed_processes(snapshot) | {COMPILER, COMPILER_OF_OTHERS}
    report = snapshot.of(records.PROCESSES)
    processes = report.value.processes if report else ()
    yield from _still_compiling(processes, snapshot)
    for process in processes:
        if process.name not in ignored and (process.state is ProcessState.DISABLED or _is_crashing(process)):
            hold_s = RESTART_HOLD_S if _is_crashing(process) else 0.0
            text = f"a part of the service {'keeps crashing' if hold_s else 'has been given up'}"
            tasks = _tasks_of(process.name, snapshot)
            without = f" ({', '.join(tasks)})" if tasks not in ((), (process.name,)) else ""
            key = f"process {process.name} {'crashing' if hold_s else 'disabled'}"
            detail = f"{process_state(process)}{without}"
            yield Cause(key, Subject.SERVICE, text, process_advice(process), detail, hold_s)
    for name, timed in snapshot.tasks.items():
        task = snapshot.task(name)
        if not task.on_frame_path and not timed.value.times.enabled and task.times.enabled:
            advice = f"Switch {name} on again on the timing page, when it is needed."
            yield Cause(f"task {name} off", Subject.SERVICE, f"task {name} is switched off", advice)


def _is_crashing(process: ProcessInfo) -> bool:
    again = process.state is ProcessState.STARTING and process.restarts > 0
    return again or process.state is ProcessState.RESTARTING


def _still_compiling(processes: Sequence[ProcessInfo], snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """Robots are served, and other tasks wait for their kernels."""
    waiting = [
        task
        for process in processes
        if process.state is ProcessState.WAITING
        for task in _tasks_of(process.name, snapshot)
    ]
    for process in processes:
        if process.name == COMPILER_OF_OTHERS and process.state is ProcessState.RUNNING:
            detail = f"{process.detail}; these tasks wait: {', '.join(waiting)}"
            yield Cause(
                "compiling others",
                Subject.SERVICE,
                "a first start: what explains and watches is still compiled",
                "Wait some seconds: robots are served already.",
                detail,
            )


def _tasks_of(process: str, snapshot: ServiceSnapshot) -> tuple[str, ...]:
    """The tasks that a process runs, in the order of the task table."""
    return tuple(task for task in snapshot.task_names if process_of(task, snapshot) == process)
