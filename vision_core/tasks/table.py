"""The task table: every process of the service, on one page.

    light -> capture -> frames -> perceive -> sightings -> serve -> datagrams
                          |                                  |  |
                          +-> obstacles ---------------------+  |
                          +-> diagnose          web  <-  everything that was written

A task runs when the record that triggers it was written; capture is released by its camera. One writer
per record, no cycle: ``problems`` proves it, a test calls it, and the supervisor starts what stands here.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from vision_core.rtdb import records
from vision_core.rtdb.layout import RecordSpec
from vision_core.settings import Settings

BY_SUPERVISOR = ("service", "processes")
"""Records that the supervisor writes."""


@dataclass(frozen=True, slots=True)
class Task:
    """One process."""

    name: str
    module: str
    """Started as ``python -m <module>``."""
    trigger: str | None
    """The record whose writing releases it; None: released by something outside."""
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    """Beside ``task/<name>``, which every task writes."""
    sockets: tuple[str, ...] = ()
    """Sockets of the supervisor that it uses."""
    needs_kernels: bool = True
    """Started only when the kernels are compiled."""
    once: bool = False
    """Runs to its end and is not started again."""


def task_table(camera: str) -> tuple[Task, ...]:
    """Every task of a service with one camera."""
    frames, source, sightings = f"frames/{camera}", f"source/{camera}", f"sightings/{camera}"
    obstacles, diagnosis = f"obstacles/{camera}", f"diagnosis/{camera}"
    return (
        Task(
            "compile",
            "vision_core.tasks.compile",
            trigger=None,
            reads=("service",),
            writes=(),
            needs_kernels=False,
            once=True,
        ),
        Task(
            "capture",
            "vision_core.tasks.capture",
            trigger=None,
            reads=("service",),
            writes=(frames, source),
        ),
        Task(
            "perceive",
            "vision_core.tasks.perceive",
            trigger=frames,
            reads=("service", frames),
            writes=(sightings,),
        ),
        Task(
            "obstacles",
            "vision_core.tasks.obstacles",
            trigger=frames,
            reads=("service", frames, sightings),
            writes=(obstacles,),
        ),
        Task(
            "diagnose",
            "vision_core.tasks.diagnose",
            trigger=frames,
            reads=("service", frames),
            writes=(diagnosis,),
        ),
        Task(
            "serve",
            "vision_core.tasks.serve",
            trigger=sightings,
            reads=("service", sightings, obstacles, "sessions"),
            writes=("world", "views", "serving", "sessions"),
            sockets=("main", "session"),
        ),
        Task(
            "web",
            "app.web_process",
            trigger=None,
            reads=(
                *("service", "processes", "world", "views", "serving"),
                *(frames, source, sightings, obstacles, diagnosis),
            ),
            writes=(),
            sockets=("http",),
            needs_kernels=False,
        ),
    )


def record_specs(settings: Settings, tasks: Sequence[Task]) -> tuple[RecordSpec, ...]:
    """Every record of the service."""
    camera = settings.camera
    return (
        records.SERVICE.spec,
        records.PROCESSES.spec,
        records.frames(camera.name, camera.width_px, camera.height_px),
        records.source(camera.name).spec,
        records.sightings(camera.name).spec,
        records.obstacles(camera.name).spec,
        records.diagnosis(camera.name).spec,
        records.WORLD.spec,
        records.VIEWS.spec,
        records.SERVING.spec,
        records.SESSIONS,
        *(records.task(task.name).spec for task in tasks),
    )


def problems(tasks: Sequence[Task]) -> list[str]:
    """What is wrong with a table: two writers, inputs that nobody writes, triggers not read, cycles."""
    found = []
    writers: dict[str, str] = dict.fromkeys(BY_SUPERVISOR, "supervisor")
    for task in tasks:
        for record in task.writes:
            if record in writers:
                found.append(f"{record} is written by {writers[record]} and by {task.name}")
            writers[record] = task.name
    for task in tasks:
        found += [f"{task.name} reads {record}, which nobody writes" for record in task.reads if record not in writers]
        if task.trigger is not None and task.trigger not in task.reads:
            found.append(f"{task.name} is triggered by {task.trigger}, which it does not read")
    for task in tasks:
        seen, trigger = {task.name}, task.trigger
        while trigger in writers:
            name = writers[trigger]
            if name in seen:
                found.append(f"{task.name} is released by a cycle through {name}")
                break
            seen.add(name)
            trigger = next((other.trigger for other in tasks if other.name == name), None)
    return found
