"""Is the service ready, and if not, why: one pure function of what was read.

Readiness is a chain: kernels -> processes -> images -> sightings -> datagrams. The first broken link is
the cause and what follows from it is not listed, so that a person reads one reason and not five.
"""

from app.web.blackboard import Readings
from vision_core.rtdb.infos import ProcessInfo

COMPILER = "compile"
NEEDED = ("source", "capture", "perceive", "serve")
"""Tasks without which no robot is served. All others watch or explain: see ``degradation``."""
MIN_PATIENCE_S = 0.25
PATIENCE_PERIODS = 3.0
"""An image is old when this many have failed to come, and never before MIN_PATIENCE_S."""


def reasons_not_ready(readings: Readings) -> tuple[str, ...]:
    """Why robots are not served right now, in words; empty when they are."""
    if readings.processes is None:
        return ("the supervisor has said nothing yet",)
    if not readings.processes.valid:
        return (f"the supervisor has been silent for {readings.processes.age_s:.1f} s",)
    processes = readings.processes.value.processes
    for process in processes:
        if process.name == COMPILER and process.state != "done":
            return (_compiling(process),)
    needed = {process_of(task, readings) for task in NEEDED}
    broken = [_broken(process) for process in processes if process.name in needed and process.state != "running"]
    return tuple(broken) or _switched_off(readings) or _silence(readings)


def process_of(task: str, readings: Readings) -> str:
    """The process that runs a task."""
    if task in readings.tasks:
        return readings.tasks[task].value.process
    return readings.service.settings.tasks[task].process or task


def _switched_off(readings: Readings) -> tuple[str, ...]:
    """Whoever it was, robots wait for it."""
    off = (task for task in NEEDED if task in readings.tasks and not readings.tasks[task].value.enabled)
    return tuple(f"task {task} is switched off" for task in off)


def _compiling(process: ProcessInfo) -> str:
    detail = f": {process.detail}" if process.detail else ""
    return f"compiling failed{detail}" if process.state in ("disabled", "stopped") else f"compiling{detail}"


def _broken(process: ProcessInfo) -> str:
    detail = f": {process.detail}" if process.detail else ""
    return f"process {process.name} is {process.state}{detail}"


def _silence(readings: Readings) -> tuple[str, ...]:
    """The first link of the chain that delivers nothing, while every process runs."""
    patience_s = max(MIN_PATIENCE_S, PATIENCE_PERIODS / _rate_hz(readings))
    if readings.frame is None:
        return (f"no image yet{_note(readings, 'source', 'capture')}",)
    if readings.frame.age_s > patience_s:
        return (f"the camera's image is {readings.frame.age_s:.1f} s old{_note(readings, 'source', 'capture')}",)
    if readings.sightings is None:
        return (f"nothing was perceived yet{_note(readings, 'perceive')}",)
    if readings.sightings.age_s > patience_s + MIN_PATIENCE_S:
        age_s = readings.sightings.age_s
        return (f"nothing is perceived: the newest sightings are {age_s:.1f} s old{_note(readings, 'perceive')}",)
    if readings.serving is None:
        return (f"clients are not served yet{_note(readings, 'serve')}",)
    if not readings.serving.valid:
        return (f"clients have not been served for {readings.serving.age_s:.1f} s{_note(readings, 'serve')}",)
    return ()


def _rate_hz(readings: Readings) -> float:
    """Of the source, which may be a slow video, else the camera's."""
    return readings.source.value.rate_hz if readings.source else readings.service.settings.camera.rate_hz


def _note(readings: Readings, *tasks: str) -> str:
    """What the first of the responsible tasks that has something to say says about it."""
    notes = (readings.tasks[task].value.note for task in tasks if task in readings.tasks)
    note = next(filter(None, notes), "")
    return f" ({note})" if note else ""
