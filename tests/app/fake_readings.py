"""What was read of a service that serves, to be changed by tests."""

from dataclasses import replace

from app.web.blackboard import FrameStamp, Readings
from tests.app.fake_tasks import Condition, process_infos, self_test, task_info
from vision_core.clock import Instant
from vision_core.rtdb.infos import Processes, ServiceInfo, Serving, TaskInfo, TaskOverride
from vision_core.rtdb.items import T, Timed
from vision_core.tasks.table import task_table
from vision_core.types.objects import Sightings
from vision_core.venues.loader import load_settings

NOW = Instant(100_000_000_000)
SEEN = Sightings("main", 7, NOW, NOW, (), (), complete=True)
SETTINGS = load_settings()
TASKS = {task.name: task for task in task_table(SETTINGS)}


def timed(value: T, age_s: float = 0.01, *, valid: bool = True) -> Timed[T]:
    """A reading of some age."""
    return Timed(value, 1, NOW, NOW, age_s, valid)


def processes(**states: tuple[str, str]) -> Timed[Processes]:
    """All processes well but for the named ones."""
    return timed(Processes(process_infos(tuple(TASKS.values()), states)))


def told(name: str, *, rights: bool = True, **changes: object) -> Timed[TaskInfo]:
    """What a task says of itself when all is well, but for some fields."""
    info = task_info(TASKS[name], TaskOverride(), 100, Condition(rights=rights))
    return timed(replace(info, **changes))  # type: ignore[arg-type]


def readings() -> Readings:
    """Of a service that serves; nobody is connected, and no task has spoken yet."""
    return Readings(
        now=NOW,
        service=ServiceInfo("1", Instant(0), "http://h:1", "h:2", SETTINGS),
        processes=processes(),
        frame=FrameStamp(7, NOW, 0.02),
        source=None,
        sightings=timed(SEEN),
        obstacles=None,
        boundary=None,
        lines=None,
        exposure=None,
        colors=None,
        diagnosis=None,
        world=None,
        views=None,
        serving=timed(Serving((), 0.0, 0.0, ())),
        self_test=self_test(Condition()),
        task_names=tuple(TASKS),
        tasks={},
        proposed={},
    )
