"""The task table: everything that runs, on one page.

    light -> capture -> frames -> perceive -> sightings -> serve -> datagrams
       source (renders)   |                                 | |
                          +-> obstacles --------------------+ |
                          +-> boundary, lines, exposure, colors, diagnose      web <- everything that was written

What a task is stands here: what releases it, what it reads, what it writes. When it runs stands in the settings
(``[tasks]`` of config/default.toml): priority, period, offset, budget, process. A venue may add tasks of its own there.
One writer per record, no cycle, rates that add up: ``check_table`` proves it before the service starts, ``pslv tasks
--check`` and a test do too; the supervisor starts what stands here, and a task gets at no other records.
"""

from collections.abc import Callable, Iterator, Sequence

from vision_core.capture.source import is_device
from vision_core.errors import SettingsError
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.rtdb.catalog import catalog
from vision_core.rtdb.layout import RecordSpec
from vision_core.scheduling.checks import TableProblem, problems
from vision_core.scheduling.task import DRIVER, NONE, Task
from vision_core.settings.schema import Settings, TaskSettings

GIVEN = ("service", "processes", "selftest")
"""Records that no task writes: the supervisor does, and what runs once at the start."""
COMPILER = "compile"
SOURCE = "source"
"""Task that plays the camera, when there is none."""
MAX_OWN = 65536
"""Record of a task of one's own [bytes]."""
PERIODS_VALID = 3.0
MAX_VALID_HZ = 12.0
"""A record of a faster task of one's own is valid for as long as one of this rate: a quarter of a second."""
S_PER_MS = 1e-3


def task_table(settings: Settings) -> tuple[Task, ...]:
    """Every task of a service with one camera, as the settings time it."""
    own = [_own(name, times) for name, times in settings.tasks.items() if times.module]
    return (*_page(settings), *own)


def _page(settings: Settings) -> Iterator[Task]:
    camera = CameraSetup.from_settings(settings).name
    frames, source, sightings = f"frames/{camera}", f"source/{camera}", f"sightings/{camera}"
    requests, done, obstacles = f"frame_requests/{camera}", f"frames_done/{camera}", f"obstacles/{camera}"
    watched = [f"{name}/{camera}" for name in ("boundary", "lines", "exposure", "colors")]
    diagnosis = f"diagnosis/{camera}"

    def line(
        name: str,
        trigger: str,
        reads: Sequence[str],
        writes: Sequence[str],
        module: str = "",
        sockets: Sequence[str] = (),
    ) -> Task:
        always = ("service", "proposed_settings")
        return _timed(
            Task(
                name=name,
                module=module or f"vision_core.tasks.{name}",
                trigger=trigger,
                reads=(*always, *reads),
                writes=tuple(writes),
                process=name,
                sockets=tuple(sockets),
                needs_kernels=name != "web",
            ),
            settings.tasks[name],
        )

    if is_device(settings):
        yield line("capture", DRIVER, [], [frames, source])
    else:  # images of a file or a simulation are made without real time, in the slots that capture names
        yield line("capture", DRIVER, [done, source], [frames, requests])
        yield line(SOURCE, requests, [requests, done, frames], [done, source])
    yield line("perceive", frames, [frames], [sightings])
    yield line(
        "serve",
        sightings,
        [sightings, obstacles, "sessions"],
        ["world", "views", "serving", "sessions", "lags"],
        sockets=["main", "session"],
    )
    yield line("obstacles", frames, [frames, sightings], [obstacles])
    for record in watched:
        yield line(record.partition("/")[0], "period", [frames], [record])
    yield line("diagnose", frames, [frames], [diagnosis])
    seen = [frames, source, sightings, obstacles, *watched, diagnosis]
    told = ["processes", "selftest", "world", "views", "serving", "lags"]
    yield line("web", NONE, [*told, *seen], ["proposed_settings"], module="app.web.process", sockets=["http"])


def _timed(task: Task, times: TaskSettings) -> Task:
    return Task(
        name=task.name,
        module=task.module,
        trigger=task.trigger,
        reads=task.reads,
        writes=task.writes,
        process=times.process or task.name,
        priority=times.priority,
        period_s=times.period_ms * S_PER_MS,
        offset_s=times.offset_ms * S_PER_MS,
        budget_s=times.budget_ms * S_PER_MS,
        enabled=times.enabled,
        cores=times.cores,
        sockets=task.sockets,
        needs_kernels=task.needs_kernels,
    )


def _own(name: str, times: TaskSettings) -> Task:
    return _timed(
        Task(
            name,
            times.module,
            times.trigger,
            ("service", "proposed_settings", *times.reads),
            times.writes,
            process=name,
        ),
        times,
    )


def check_table(settings: Settings, place_of: Callable[[str], str]) -> None:
    """Raise SettingsError for the first thing that is wrong; place_of names file and line of a setting."""
    tasks = task_table(settings)
    names = {task.name for task in tasks} | {SOURCE}
    unknown = (name for name in settings.tasks if name not in names)
    accepted = f"{', '.join(sorted(names))}, or with a module a task of your own"
    strangers = [TableProblem(f"tasks.{name}", "no task of this name", accepted) for name in unknown]
    told = [f"{kind}/{task.name}" for task in tasks for kind in ("task", "timing")]
    beats = [f"heartbeat/{process}" for process in (COMPILER, *{task.process for task in tasks})]
    found = problems(tasks, (*GIVEN, *told, *beats), CameraSetup.from_settings(settings).rate_hz)
    for problem in (*strangers, *_misplaced(settings), *found):
        where = f"{place_of(problem.key)}: {problem.key}"
        raise SettingsError(where, found=problem.found, accepted=problem.accepted)


def _misplaced(settings: Settings) -> Iterator[TableProblem]:
    """What a line may not say: of a task that has its place on this page, or of one that has none."""
    ours = {task.name for task in _page(settings)} | {SOURCE}
    for name, times in settings.tasks.items():
        if name in ours and (times.module or times.reads or times.writes or times.trigger != "period"):
            said = "module, trigger, reads or writes"
            yield TableProblem(f"tasks.{name}", said, "its times only: vision_core/tasks/table.py says the rest")
        if name == "web" and times.process not in ("", name):
            yield TableProblem("tasks.web.process", times.process, "a process of its own: it has a loop of its own")
        if COMPILER in (name, times.process):
            yield TableProblem(f"tasks.{name}", COMPILER, "another name: this one has a process of its own")


def record_specs(settings: Settings, tasks: Sequence[Task], processes: Sequence[str]) -> tuple[RecordSpec, ...]:
    """Every record of the service; processes: everything that must say that it lives."""
    camera = CameraSetup.from_settings(settings)
    declared = [
        records.SERVICE.spec,
        *(item.spec for item in catalog(camera.name)),
        *(kind(camera.name).spec for kind in records.HANDSHAKE),
        records.SESSIONS,
        records.LAG_HISTOGRAMS,
        records.frames(camera.name, *camera.size_px),
        *(records.task(task.name).spec for task in tasks),
        *(records.timing(task.name) for task in tasks),
        *(records.heartbeat(process) for process in processes),
    ]
    there = {spec.name for spec in declared}
    own = [
        RecordSpec(record, MAX_OWN, PERIODS_VALID / min(task.rate_hz(camera.rate_hz), MAX_VALID_HZ))
        for task in tasks
        for record in task.writes
        if record not in there
    ]
    return (*declared, *own)
