"""What keeps robots from being served: a pure function of one snapshot.

Readiness is a chain: kernels -> processes -> images -> sightings -> datagrams. Only the first broken link is reported,
because everything after it follows from it.
"""

from app.web.blackboard import ServiceSnapshot
from app.web.health.frame_path import camera_task, frame_path, image_tasks
from vision_core.rtdb import records
from vision_core.rtdb.infos import ProcessInfo
from vision_core.rtdb.process_state import ProcessState
from vision_core.rtdb.task import Task

COMPILER = "compile"
MIN_PATIENCE_S = 0.25
PATIENCE_PERIODS = 3.0
"""An image is old when this many have failed to come, and never before MIN_PATIENCE_S."""
MAX_SLOWED_PATIENCE_S = 1.0
"""A camera that delivers fewer images than it promises is given its periods up to this time, so that the state does not
change with every image; a camera that has failed is reported by then."""


def reasons_not_ready(snapshot: ServiceSnapshot) -> tuple[str, ...]:
    """Why no robot can be served right now; empty when robots are served."""
    report = snapshot.of(records.PROCESSES)
    if report is None:
        return ("the supervisor has not reported yet",)
    if not report.valid:
        return (f"the supervisor has not reported for {report.age_s:.1f} s",)
    processes = report.value.processes
    for process in processes:
        if process.name == COMPILER and process.state is not ProcessState.DONE:
            return (_compiling(process),)
    needed = needed_processes(snapshot)
    broken = [
        process_state(process)
        for process in processes
        if process.name in needed and process.state is not ProcessState.RUNNING
    ]
    return tuple(broken) or _switched_off(snapshot) or _silence(snapshot)


def is_starting(snapshot: ServiceSnapshot) -> bool:
    """Is a needed process started for the first time, or does it wait for the compiler?"""
    needed = needed_processes(snapshot) | {COMPILER}
    report = snapshot.of(records.PROCESSES)
    processes = report.value.processes if report else ()
    first = [process for process in processes if process.name in needed and not process.restarts]
    return not processes or any(
        process.state in (ProcessState.WAITING, ProcessState.STARTING)
        or (process.name == COMPILER and process.state is ProcessState.RUNNING)
        for process in first
    )


def needed_processes(snapshot: ServiceSnapshot) -> set[str]:
    """The processes that run the needed tasks."""
    return {task.process for task in snapshot.service.tasks if task.on_frame_path}


def process_of(task: str, snapshot: ServiceSnapshot) -> str:
    """The process that runs a task."""
    return snapshot.task(task).process


def process_state(process: ProcessInfo) -> str:
    """The sentence that reports a process that does not run."""
    detail = f": {process.detail}" if process.detail else ""
    return f"process {process.name} is {process.state}{detail}"


def _switched_off(snapshot: ServiceSnapshot) -> tuple[str, ...]:
    needed = [task.name for task in snapshot.service.tasks if task.on_frame_path]
    off = (name for name in needed if name in snapshot.tasks and not snapshot.tasks[name].value.times.enabled)
    return tuple(f"task {task} is switched off" for task in off)


def _compiling(process: ProcessInfo) -> str:
    detail = f": {process.detail}" if process.detail else ""
    return (
        f"compiling failed{detail}"
        if process.state in (ProcessState.DISABLED, ProcessState.STOPPED)
        else f"compiling{detail}"
    )


def _silence(snapshot: ServiceSnapshot) -> tuple[str, ...]:
    """The first link of the chain that delivers nothing although every process runs."""
    patience_s = _patience_s(snapshot)
    _, perceive, serve = frame_path(snapshot)
    if snapshot.frame is None:
        return (f"no image yet{_note(snapshot, *image_tasks(snapshot))}",)
    if snapshot.frame.age_s > patience_s:
        return (f"the camera's image is {snapshot.frame.age_s:.1f} s old{_note(snapshot, *image_tasks(snapshot))}",)
    sightings, serving = snapshot.of(records.sightings), snapshot.of(records.SERVING)
    if sightings is None:
        return (f"no image has been analyzed yet{_note(snapshot, perceive)}",)
    if sightings.age_s > patience_s + MIN_PATIENCE_S:
        return (f"no image has been analyzed for {sightings.age_s:.1f} s{_note(snapshot, perceive)}",)
    if serving is None:
        return (f"clients are not served yet{_note(snapshot, serve)}",)
    if not serving.valid:
        return (f"clients have not been served for {serving.age_s:.1f} s{_note(snapshot, serve)}",)
    return ()


def _patience_s(snapshot: ServiceSnapshot) -> float:
    """How old an image may be [s]."""
    source, capture = snapshot.of(records.source), snapshot.tasks.get(camera_task(snapshot).name)
    promised_hz = source.value.rate_hz if source else snapshot.camera.rate_hz
    measured_hz = capture.value.rate_hz if capture and capture.valid else 0.0
    slowed_s = min(PATIENCE_PERIODS / measured_hz, MAX_SLOWED_PATIENCE_S) if measured_hz else 0.0
    return max(MIN_PATIENCE_S, PATIENCE_PERIODS / promised_hz, slowed_s)


def _note(snapshot: ServiceSnapshot, *tasks: Task) -> str:
    """The note of the first of the tasks that has one, in parentheses."""
    notes = (snapshot.tasks[task.name].value.note for task in tasks if task.name in snapshot.tasks)
    note = next(filter(None, notes), "")
    return f" ({note})" if note else ""
