"""What ``/api/v1/tasks`` tells about every task of the table."""

from dataclasses import fields
from typing import Any

from msgspec.structs import asdict
from pydantic import ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.rtdb.infos import TaskInfo, TaskOverride
from vision_core.rtdb.task import HIGHEST_PRIORITY
from vision_core.settings.schema import TaskTimes

MAX_PERIOD_MS = 3.6e6


class Wish(Report):
    """How somebody wants a task to run; null: as the table has it."""

    model_config = ConfigDict(strict=True, allow_inf_nan=False)

    enabled: bool | None = None
    """Switched on or off."""
    period_ms: float | None = Field(default=None, ge=0.0, le=MAX_PERIOD_MS)
    """0: with every writing of its trigger."""
    priority: int | None = Field(default=None, ge=0, le=HIGHEST_PRIORITY)
    """SCHED_FIFO; 0: an ordinary process."""

    @model_validator(mode="before")
    @classmethod
    def _only_known(cls, data: object) -> object:
        if isinstance(data, dict) and (unknown := sorted(set(map(str, data)) - set(cls.model_fields))):
            known = f"{', '.join(cls.model_fields)}; not {', '.join(unknown)}"
            raise PydanticCustomError("unknown_key", "{known}", {"known": known})
        return data

    @staticmethod
    def of(proposal: TaskOverride) -> "Wish":
        """A proposal, as it is told."""
        return Wish(enabled=proposal.enabled, period_ms=proposal.period_ms, priority=proposal.priority)


class Task(Report):
    """One task, as it says itself; what it has never said is null."""

    name: str
    process: str
    """Tasks that share a process take turns in it, the highest priority first."""
    enabled: bool
    trigger: str | None = None
    """driver, period, none (a loop of its own), or the record whose writing releases it."""
    period_ms: float
    """In effect; 0: with every writing of its trigger."""
    offset_ms: float
    """Of the period's grid."""
    priority: int
    """Asked for: SCHED_FIFO, 0 for an ordinary process."""
    budget_ms: float
    """A longer run counts as an overrun; 0: none is counted."""
    policy: str | None = None
    """What it has got: "FIFO 45", "nice -10" or "ordinary"."""
    refused: str | None = None
    """Why that is not what was asked for; empty when it is."""
    runs: int | None = None
    """Since its start, as the next three."""
    missed: int | None = None
    """Releases that passed without a run."""
    overruns: int | None = None
    """Runs longer than the budget."""
    collections: int | None = None
    """Of garbage, all between two runs."""
    rate_hz: float | None = None
    """Of late, as all that follows."""
    response_median_ms: float | None = None
    """From a release to its result."""
    response_max_ms: float | None = None
    interval_mean_ms: float | None = None
    """Between the beginnings of two runs."""
    interval_sd_ms: float | None = None
    """Its standard deviation: the jitter."""
    note: str = ""
    """What a person should know."""
    age_s: float | None = None
    """Since it last spoke; null: it never did."""
    valid: bool = False
    """It has spoken lately enough to be believed."""
    proposed: Wish | None = None
    """What somebody wants of it; null: nothing but what the table says."""


REPORTED = tuple(entry.name for entry in fields(TaskInfo) if entry.name in Task.model_fields)
"""Fields that a task's record and its report have in common, beside those of its times."""


def task_from(snapshot: ServiceSnapshot, name: str) -> Task:
    """The report of one task. Raises KeyError for one that is not on the table."""
    line, timed, override = snapshot.task(name), snapshot.tasks.get(name), snapshot.overrides.get(name)
    proposed = Wish.of(override) if override is not None else None
    if timed is None:
        return Task(name=name, process=line.process, trigger=line.trigger, proposed=proposed, **_times(line.times))
    reported = {key: getattr(timed.value, key) for key in REPORTED}
    return Task(
        name=name,
        age_s=timed.age_s,
        valid=timed.valid,
        proposed=proposed,
        refused="; ".join(map(str, timed.value.refusals)),
        **reported,
        **_times(timed.value.times),
    )


def tasks_from(snapshot: ServiceSnapshot) -> list[Task]:
    """The reports of all tasks, in the table's order."""
    return [task_from(snapshot, name) for name in snapshot.task_names]


def _times(times: TaskTimes) -> dict[str, Any]:
    return {name: value for name, value in asdict(times).items() if name in Task.model_fields}
