"""A snapshot of a service that serves, for tests to change."""

from dataclasses import replace
from typing import Any

from app.web.blackboard import FrameStamp, ServiceSnapshot
from tests.app.fake_tasks import Condition, process_infos, self_test, task_info
from vision_core.clock import Instant
from vision_core.rtdb import records
from vision_core.rtdb.catalog import Snapshot
from vision_core.rtdb.infos import Processes, ServiceInfo, Serving, TaskInfo, TaskOverride
from vision_core.rtdb.items import T, Timed
from vision_core.tasks.table import task_table
from vision_core.types.objects import RobotSighting, Sightings, Team
from vision_core.venues.loader import load_settings

NOW = Instant(100_000_000_000)
ROBOT = RobotSighting(Team.BLUE, 1, 320.0, 240.0, 0.0, 0.0, 0.0, 0.9, 0.001, 0.01)
SEEN = Sightings("main", 7, NOW, NOW, (ROBOT,), (), complete=True)
UNCHANGED = TaskOverride()
EMPTY_FIELD = Sightings("main", 7, NOW, NOW, (), (), complete=True)
SETTINGS = load_settings()
TASKS = {task.name: task for task in task_table(SETTINGS)}


def timed(value: T, age_s: float = 0.01, *, valid: bool = True) -> Timed[T]:
    """A record of some age."""
    return Timed(value, 1, NOW, NOW, age_s, valid)


def processes(**states: tuple[str, str]) -> Timed[Processes]:
    """All processes run but the named ones, which have a state and a detail."""
    return timed(Processes(process_infos(tuple(TASKS.values()), states)))


def task_report(
    name: str, override: TaskOverride = UNCHANGED, *, rights: bool = True, **changes: object
) -> Timed[TaskInfo]:
    """The record of a task that runs well, with some fields changed."""
    info = task_info(TASKS[name], override, 100, Condition(rights=rights))
    return timed(replace(info, **changes))  # type: ignore[arg-type]


def serving_snapshot() -> ServiceSnapshot:
    """A service that serves; no client is connected, and no task has reported yet."""
    values: dict[str, Timed[Any]] = {
        "processes": processes(),
        "sightings": timed(SEEN),
        "serving": timed(Serving((), 0.0, 0.0, ())),
        "selftest": timed(self_test(Condition())),
    }
    return ServiceSnapshot(
        now=NOW,
        service=ServiceInfo("1", Instant(0), "http://h:1", "h:2", SETTINGS, tuple(TASKS.values())),
        frame=FrameStamp(7, NOW, 0.02),
        values=Snapshot(values),
        task_names=tuple(TASKS),
        tasks={},
    )


def with_records(snapshot: ServiceSnapshot, **values: Timed[Any] | None) -> ServiceSnapshot:
    """The snapshot with other values of some records of the catalog, by name; None: never written."""
    before = {record.name: snapshot.of(record) for record in records.CATALOG}
    after = {name: timed for name, timed in {**before, **values}.items() if timed is not None}
    return replace(snapshot, values=Snapshot(after))
