"""The task table: everything that runs, on one page.

    light -> capture -> frames -> perceive -> sightings -> serve -> datagrams
       source (renders)   |   ^                    |        | |
                          |   |                    +-> contours, lines (what robots cover)
                          |   +-- palette <- follow         | |
                          |   +-- suggestions <- search     | |
                          +-> obstacles --------------------+ |
                          +-> boundary, lines, exposure, colors, diagnose      web <- everything that was written
                          +-> overlay <- looking <- web
       source <- drives <- serve, and source -> game -> web: robots that clients drive in a simulated match

This table declares what releases a task, what it reads and what it writes. The settings (``[tasks]`` of
config/default.toml) declare its times: priority, period, offset, budget, process. A venue may add its own tasks there.
``check_table`` checks before the service starts that each record has one writer, that there is no cycle and that the
rates are possible; ``pslv tasks --check`` and a test do the same. The supervisor starts exactly these tasks, and a task
can access only the records that its line names. All other facts about a task are fields of ``rtdb.task.Task``.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

from vision_core.errors import SettingsError
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.rtdb.catalog import catalog
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.log_record import LOG
from vision_core.rtdb.task import DRIVER, NONE, PERIOD, Task
from vision_core.scheduling.checks import TableProblem, problems
from vision_core.settings.schema import SYNTHETIC, Settings, TaskSettings

COMPILER = "compile"
"""Process that compiles the kernels of the frame path once, before its tasks start."""
COMPILER_OF_OTHERS = "compile_others"
"""Process that compiles all other kernels once, while the frame path runs and before the other tasks start."""
RESPONDER = "responder"
"""Process that answers clients while the task serve does not run."""
LOG_READER = "log_reader"
"""Process that prints what the others print."""
GIVEN = {**dict.fromkeys(("service", "processes", "selftest"), "supervisor"), "log": LOG_READER}
"""Records that no task writes, and which process does."""
SOURCE = "source"
"""Task that plays the camera when the source is no device."""
WEB = "web"
"""Task that shows the page."""
RESERVED = (COMPILER, COMPILER_OF_OTHERS, RESPONDER, LOG_READER)
"""Processes that run no task of the table."""
MAX_OWN = 65536
"""Size of a record that a user's own task writes [bytes]."""
VALID_PERIODS = 3.0
MAX_VALID_HZ = 12.0
"""A record of a user's own task is valid for VALID_PERIODS of the task, but for a quarter of a second at least: tasks
faster than this count as if they ran at it."""
ONCE_A_SECOND = TaskSettings(priority=0, period_ms=1000.0, budget_ms=0.0)
"""Times of a watcher that has no entry in ``[tasks]``: it runs without real-time priority."""
ALWAYS_READ = ("service", "live_settings")
"""Records that every task may read."""


def task_table(settings: Settings) -> tuple[Task, ...]:
    """Every task of a service with one camera, with the times of the settings."""
    own = [_own(name, line) for name, line in settings.tasks.items() if line.module]
    return (*_built_in(settings), *own)


def _built_in(settings: Settings) -> Iterator[Task]:
    camera = CameraSetup.from_settings(settings).name
    frames, source, sightings = f"frames/{camera}", f"source/{camera}", f"sightings/{camera}"
    obstacles, diagnosis = f"obstacles/{camera}", f"diagnosis/{camera}"
    line = partial(_line, settings)

    def watcher(name: str, purpose: str, *others: str) -> Task:
        """A task that looks at the newest image of the camera periodically; its record has its name.

        others: what it reads beside the images.

        A new one needs its module beside this file, its line below, its record in ``rtdb.records`` and, to be shown on
        the page, its report in ``app/web/reports/checks.py``.
        """
        return line(name, PERIOD, [frames, *others], [f"{name}/{camera}"], purpose=purpose)

    yield from _camera_tasks(settings, camera)
    palette = records.palette(camera).name
    suggestions = records.suggestions(camera).name
    seen_by = [frames, palette, suggestions]
    yield line("perceive", frames, seen_by, [sightings], on_frame_path=True, purpose="finds robots and ball")
    yield line("follow", PERIOD, [frames], [palette], purpose="keeps the colors right in other light")
    yield line("search", PERIOD, [frames, palette], [suggestions], purpose="finds robots whose colors cannot be seen")
    yield line(
        "serve",
        sightings,
        [sightings, obstacles, "sessions", "drives", "fairness"],
        ["world", "views", "serving", "sessions", "drives", "lags", "fairness", "fairness_ended"],
        sockets=("main", "session"),
        on_frame_path=True,
        purpose="sends every robot its view",
    )
    seen, covered = [sightings, "world"], [f"contours/{camera}"]
    yield line("contours", PERIOD, seen, covered, purpose="says what robots cover, and if the ball may be hidden there")
    yield line("obstacles", frames, [frames, sightings], [obstacles], purpose="finds obstacles")
    watchers = (
        watcher("boundary", "finds where the field ends"),
        watcher("lines", "checks that the camera was not moved", sightings),
        watcher("exposure", "checks the brightness"),
        watcher("colors", "checks the light"),
    )
    yield from watchers
    yield line("diagnose", frames, seen_by, [diagnosis], purpose="explains why something is not seen")
    looks, overlay = records.LOOKING.name, records.overlay(camera).name
    yield line(
        "overlay", PERIOD, [frames, looks, palette], [overlay], purpose="draws what is found while somebody looks"
    )
    watched = [record for task in watchers for record in task.writes]
    shown = [frames, source, sightings, obstacles, *watched, *covered, diagnosis, overlay, palette]
    shown += ["processes", "selftest", "log", "world", "views", "serving", "lags", "fairness", "fairness_ended"]
    shown += _game_records(settings)
    yield line(
        WEB,
        NONE,
        shown,
        ["live_settings", "restart_request", looks],
        sockets=("http",),
        needs_kernels=False,
        purpose="shows this page",
    )


def _camera_tasks(settings: Settings, camera: str) -> Iterator[Task]:
    """The tasks that publish frames: capture reads a device, or requests each frame from the task source."""
    frames, source = f"frames/{camera}", f"source/{camera}"
    requests, done = f"frame_requests/{camera}", f"frames_done/{camera}"
    line = partial(_line, settings, on_frame_path=True)
    capture = partial(line, "capture", DRIVER, purpose="reads the camera", period_owner="the camera")
    if settings.source.device is not None:
        yield capture([], [frames, source])
        return
    yield capture([done, source], [frames, requests])
    yield line(
        SOURCE,
        requests,
        [requests, done, frames, "drives"],
        [done, source, *_game_records(settings)],
        purpose="plays the camera",
        period_owner="the task capture",
    )


def _game_records(settings: Settings) -> list[str]:
    """The record of the match, where it is simulated."""
    return [records.GAME.name] if settings.source.uri == SYNTHETIC else []


def _line(
    settings: Settings, name: str, trigger: str, reads: Sequence[str], writes: Sequence[str], **facts: Any
) -> Task:  # fmt: skip
    """One line of the table, with the times of the settings; facts: further fields of ``Task``."""
    declared = settings.tasks[name] if trigger != PERIOD else settings.tasks.get(name, ONCE_A_SECOND)
    return Task(
        name=name,
        module="" if trigger == NONE else f"{__package__}.{name}",
        trigger=trigger,
        reads=(*ALWAYS_READ, *reads),
        writes=tuple(writes),
        process=declared.process or name,
        times=declared.times,
        **facts,
    )


def _own(name: str, line: TaskSettings) -> Task:
    """A task that a user's venue declares."""
    return Task(
        name=name,
        module=line.module,
        trigger=line.trigger,
        reads=(*ALWAYS_READ, *line.reads),
        writes=line.writes,
        process=line.process or name,
        times=line.times,
    )


def check_table(settings: Settings, place_of: Callable[[str], str]) -> None:
    """Raise SettingsError for the first error in the table; place_of: file and line of a setting."""
    tasks = task_table(settings)
    names = {task.name for task in tasks} | {SOURCE}
    unknown = (name for name in settings.tasks if name not in names)
    accepted = f"{', '.join(sorted(names))}, or with a module a task of your own"
    unknown_tasks = [TableProblem(f"tasks.{name}", "no task of this name", accepted) for name in unknown]
    own_records = [f"{kind}/{task.name}" for task in tasks for kind in ("task", "timing")]
    heartbeats = [f"heartbeat/{process}" for process in (*RESERVED, *{task.process for task in tasks})]
    found = problems(tasks, (*GIVEN, *own_records, *heartbeats), CameraSetup.from_settings(settings).rate_hz)
    for problem in (*unknown_tasks, *_misplaced(settings), *found):
        where = f"{place_of(problem.key)}: {problem.key}"
        raise SettingsError(where, found=problem.found, accepted=problem.accepted)


def _misplaced(settings: Settings) -> Iterator[TableProblem]:
    """Settings that are not allowed: other settings than times for a built-in task, and reserved names."""
    built_in = {task.name: task for task in _built_in(settings)}
    for name, line in settings.tasks.items():
        is_built_in = name in built_in or name == SOURCE
        if is_built_in and (line.module or line.reads or line.writes or line.trigger != PERIOD):
            found = "module, trigger, reads or writes"
            yield TableProblem(f"tasks.{name}", found, "its times only: vision_core/tasks/table.py says the rest")
        if name in built_in and built_in[name].own_loop and line.process not in ("", name):
            yield TableProblem(f"tasks.{name}.process", line.process, "a process of its own: it has a loop of its own")
        for reserved in sorted(set(RESERVED) & {name, line.process}):
            yield TableProblem(f"tasks.{name}", reserved, "another name: this one has a process of its own")


def record_specs(settings: Settings, tasks: Sequence[Task], processes: Sequence[str]) -> tuple[RecordSpec, ...]:
    """Every record of the service. processes: names of the processes that write a heartbeat."""
    camera = CameraSetup.from_settings(settings)
    declared = [
        records.SERVICE.spec,
        LOG.spec,
        *(item.spec for item in catalog(camera.name)),
        *(kind(camera.name).spec for kind in records.HANDSHAKE),
        records.RESTART_REQUEST.spec,
        records.LOOKING.spec,
        records.overlay(camera.name).spec,
        records.SESSIONS,
        records.DRIVES,
        records.LAG_HISTOGRAMS,
        records.FAIRNESS_RECORD,
        records.FAIRNESS_ENDED,
        records.frames(camera.name, *camera.size_px),
        *(records.task(task.name).spec for task in tasks),
        *(records.timing(task.name) for task in tasks),
        *(records.heartbeat(process) for process in processes),
    ]
    names = {spec.name for spec in declared}
    own = [
        RecordSpec(record, MAX_OWN, VALID_PERIODS / min(task.rate_hz(camera.rate_hz), MAX_VALID_HZ))
        for task in tasks
        for record in task.writes
        if record not in names
    ]
    return (*declared, *own)
