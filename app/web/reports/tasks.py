"""How each task of the task table runs, and how it is overridden."""

from dataclasses import asdict, fields
from typing import Any

from msgspec.structs import asdict as struct_dict
from pydantic import ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.rtdb.infos import TaskInfo, TaskOverride
from vision_core.rtdb.task import HIGHEST_PRIORITY
from vision_core.settings.schema import TaskTimes

MAX_PERIOD_MS = 3.6e6


class Override(Report):
    """Values that replace those of the settings while the service runs; null: the value of the settings."""

    model_config = ConfigDict(strict=True, allow_inf_nan=False)

    enabled: bool | None = None
    """false: the task does not run."""
    period_ms: float | None = Field(default=None, ge=0.0, le=MAX_PERIOD_MS)
    """Shortest time between two runs [ms]; 0: a run each time that its trigger is written."""
    priority: int | None = Field(default=None, ge=0, le=HIGHEST_PRIORITY)
    """SCHED_FIFO priority; 0: an ordinary process."""
    rehearse: bool | None = None
    """Repeat the last run shortly before the next, for warm caches, if the task can."""

    @model_validator(mode="before")
    @classmethod
    def _only_known(cls, data: object) -> object:
        if isinstance(data, dict) and (unknown := sorted(set(map(str, data)) - set(cls.model_fields))):
            known = f"{', '.join(cls.model_fields)}; not {', '.join(unknown)}"
            raise PydanticCustomError("unknown_key", "{known}", {"known": known})
        return data

    @staticmethod
    def of(override: TaskOverride) -> "Override":
        """The report of an override."""
        return Override(**asdict(override))


class RehearsalReport(Report):
    """How often a task has repeated its last run shortly before the next one, so that this finds warm caches."""

    rehearsed: int
    cut_short: int
    """Gave way to a release."""
    skipped: int
    """Releases before which there was no time for one."""
    spent_s: float
    """In rehearsals, and in watching for the release after them [s]."""


class TaskReport(Report):
    """One task as it reports itself; null for what it has not reported yet."""

    name: str
    process: str
    """Its process. Tasks that share one run one after the other, the highest priority first."""
    enabled: bool
    """false: switched off."""
    trigger: str | None = None
    """What starts a run: driver, period, none (the task has a loop of its own), or the record whose writing does."""
    period_ms: float
    """Shortest time between two runs [ms]; 0: a run each time that its trigger is written."""
    offset_ms: float
    """Shift of its runs on the common time grid [ms]."""
    priority: int
    """SCHED_FIFO priority that it asks for; 0: an ordinary process."""
    rehearse: bool
    """It may rehearse its next run, if it can."""
    budget_ms: float
    """A run that takes longer counts as an overrun [ms]; 0: none is counted."""
    policy: str | None = None
    """Scheduling policy that it was granted: "FIFO 45", "nice -10" or "ordinary"."""
    refused: str | None = None
    """Why it was granted less than it asked for; empty when it was granted all."""
    runs: int | None = None
    """Runs since its start."""
    missed: int | None = None
    """Triggers since its start that were followed by no run."""
    overruns: int | None = None
    """Runs since its start that took longer than the budget."""
    collections: int | None = None
    """Garbage collections since its start, all of them between two runs."""
    rate_hz: float | None = None
    """Runs per second over the last 5 s [1/s]."""
    response_median_ms: float | None = None
    """From the trigger to the end of the run, over the last half second [ms]."""
    response_max_ms: float | None = None
    interval_mean_ms: float | None = None
    """Between the beginnings of two runs, over the last 256 runs [ms]."""
    interval_sd_ms: float | None = None
    """Standard deviation of these intervals [ms]: the jitter."""
    rehearsals: RehearsalReport | None = None
    """null: the task has no rehearsal."""
    note: str = ""
    """What the task reports in words: an error, or what it waits for."""
    age_s: float | None = None
    """Time since its newest report [s]; null: it has not reported yet."""
    valid: bool = False
    """Its newest report is recent enough to be believed."""
    proposed: Override | None = None
    """The override in effect; null: it runs as the settings have it."""


REPORTED = tuple(entry.name for entry in fields(TaskInfo) if entry.name in TaskReport.model_fields)
"""Fields that a task's record and its report have in common, beside those of its times."""


def task_from(snapshot: ServiceSnapshot, name: str) -> TaskReport:
    """The report of one task. Raises KeyError for a task that is not in the task table."""
    line, timed, override = snapshot.task(name), snapshot.tasks.get(name), snapshot.overrides.get(name)
    proposed = Override.of(override) if override is not None else None
    if timed is None:
        return TaskReport(
            name=name, process=line.process, trigger=line.trigger, proposed=proposed, **_times(line.times)
        )
    reported = {key: getattr(timed.value, key) for key in REPORTED}
    rehearsals = timed.value.rehearsals
    reported["rehearsals"] = RehearsalReport(**asdict(rehearsals)) if rehearsals else None
    return TaskReport(
        name=name,
        age_s=timed.age_s,
        valid=timed.valid,
        proposed=proposed,
        refused="; ".join(map(str, timed.value.refusals)),
        **reported,
        **_times(timed.value.times),
    )


def tasks_from(snapshot: ServiceSnapshot) -> list[TaskReport]:
    """The reports of all tasks, in the order of the task table."""
    return [task_from(snapshot, name) for name in snapshot.task_names]


def _times(times: TaskTimes) -> dict[str, Any]:
    return {name: value for name, value in struct_dict(times).items() if name in TaskReport.model_fields}
