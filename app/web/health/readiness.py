"""What keeps robots from being served: a pure function of one snapshot.

Readiness is a chain: kernels -> processes -> images -> sightings -> datagrams. Only the first broken link is reported,
because everything after it follows from it.
"""

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Cause, Subject
from app.web.health.frame_path import camera_task, frame_path, image_tasks
from vision_core.rtdb import records
from vision_core.rtdb.infos import ProcessInfo
from vision_core.rtdb.process_state import ProcessState
from vision_core.rtdb.task import Task

COMPILER, COMPILER_OF_OTHERS = "compile", "compile_others"
"""The processes that run once: for the frame path, and for everything else while robots are served."""
MIN_PATIENCE_S = 0.25
PATIENCE_PERIODS = 3.0
"""An image is old when this many have failed to come, and never before MIN_PATIENCE_S."""
MAX_SLOWED_PATIENCE_S = 1.0
"""A camera that delivers fewer images than it promises is given its periods up to this time, so that the state does not
change with every image; a camera that has failed is reported by then."""


IT_STARTS_AGAIN = "Wait a few seconds; if it stays so, read the log and start the service again."
CHECK_CAMERA = "Check the camera's cable and power, and source.uri on the settings page."


def reasons_not_ready(snapshot: ServiceSnapshot) -> tuple[Cause, ...]:
    """Why no robot can be served right now; empty when robots are served."""
    report = snapshot.of(records.PROCESSES)
    if report is None:
        return (_cause("supervisor", "the supervisor has not reported yet", IT_STARTS_AGAIN),)
    if not report.valid:
        return (_cause("supervisor", f"the supervisor has not reported for {report.age_s:.1f} s", IT_STARTS_AGAIN),)
    processes = report.value.processes
    for process in processes:
        if process.name == COMPILER and process.state is not ProcessState.DONE:
            return (_compiling(process),)
    needed = needed_processes(snapshot)
    broken = [
        _cause(f"process {process.name}", process_state(process), process_advice(process))
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


def process_advice(process: ProcessInfo) -> str:
    """What to do about a process that does not run."""
    if process.state is ProcessState.DISABLED:
        return f"Read its last words on the timing page and in the log, then run `pslv restart {process.name}`."
    if process.state is ProcessState.RESTARTING or process.restarts:
        return "Wait: it is started again; if it keeps ending, read its last words on the timing page and in the log."
    return "Wait until it has started; if it does not, read the log."


def _cause(key: str, text: str, advice: str, about: Subject = Subject.SERVICE) -> Cause:
    """A reason why no robot is served."""
    return Cause(f"not ready: {key}", about, text, advice)


def _switched_off(snapshot: ServiceSnapshot) -> tuple[Cause, ...]:
    needed = [task.name for task in snapshot.service.tasks if task.on_frame_path]
    off = (name for name in needed if name in snapshot.tasks and not snapshot.tasks[name].value.times.enabled)
    return tuple(
        _cause(f"task {task} off", f"task {task} is switched off", f"Switch {task} on again on the timing page.")
        for task in off
    )


def _compiling(process: ProcessInfo) -> Cause:
    detail = f": {process.detail}" if process.detail else ""
    if process.state in (ProcessState.DISABLED, ProcessState.STOPPED):
        advice = "Read the compiler's error in the log, then start the service again."
        return _cause("compiling failed", f"compiling failed{detail}", advice)
    return _cause("compiling", f"compiling{detail}", "Wait: a first start compiles for about half a minute.")


def _silence(snapshot: ServiceSnapshot) -> tuple[Cause, ...]:
    """The first link of the chain that delivers nothing although every process runs."""
    patience_s = _patience_s(snapshot)
    _, perceive, serve = frame_path(snapshot)
    note = _note(snapshot, *image_tasks(snapshot))
    if snapshot.frame is None:
        return (_cause("no image", f"no image yet{note}", CHECK_CAMERA, Subject.CAMERA),)
    if snapshot.frame.age_s > patience_s:
        old = f"the camera's image is {snapshot.frame.age_s:.1f} s old{note}"
        return (_cause("no image", old, CHECK_CAMERA, Subject.CAMERA),)
    sightings, serving = snapshot.of(records.sightings), snapshot.of(records.SERVING)
    if sightings is None or sightings.age_s > patience_s + MIN_PATIENCE_S:
        since = "yet" if sightings is None else f"for {sightings.age_s:.1f} s"
        text = f"no image has been analyzed {since}{_note(snapshot, perceive)}"
        return (_cause("not analyzed", text, IT_STARTS_AGAIN, Subject.LAG),)
    if serving is None or not serving.valid:
        since = "are not served yet" if serving is None else f"have not been served for {serving.age_s:.1f} s"
        text = f"clients {since}{_note(snapshot, serve)}"
        return (_cause("not served", text, IT_STARTS_AGAIN, Subject.LAG),)
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
