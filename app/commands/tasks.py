"""``pslv tasks``: the task table, whether it is sound, and how the tasks of a running service keep their times."""

import os
import sys
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from app.commands.options import ConfigFile, Venue
from app.commands.running import only_service
from vision_core.models.camera_setup import CameraSetup

if TYPE_CHECKING:
    from vision_core.rtdb.infos import TaskInfo
    from vision_core.rtdb.task import Task


def tasks(
    venue: Venue = None,
    config: ConfigFile = None,
    check: Annotated[bool, typer.Option("--check", help="Say whether it is sound; exit status 2 if not.")] = False,
    live: Annotated[bool, typer.Option("--live", help="Print how the tasks of a running service run.")] = False,
    service: Annotated[str | None, typer.Option(help="Its name, when several run: pslv/8000.")] = None,
) -> None:
    """Print the task table: what runs when, at which priority, and what it reads and writes."""
    out = Console(highlight=False, width=None if sys.stdout.isatty() else 200)
    if live:
        out.print(_live(service or only_service("pslv tasks --live --service")))
        return
    from vision_core.scheduling.checks import load, warnings
    from vision_core.tasks.table import check_table, task_table
    from vision_core.venues.loader import layers_of, place_of, settings_from_layers

    layers = layers_of(venue, config)
    settings = settings_from_layers(layers)
    table, rate_hz = task_table(settings), CameraSetup.from_settings(settings).rate_hz
    if not check:
        out.print(_drawn(table))
    check_table(settings, lambda key: place_of(key, layers))
    for warning in warnings(table):
        out.print(f"warning: {warning}", soft_wrap=True)
    cores, processes = len(os.sched_getaffinity(0)), len({task.process for task in table})
    used = f"budgets of real-time tasks fill {load(table, rate_hz):.2f} of {cores} cores at {rate_hz:g} frames a second"
    out.print(f"in order: {len(table)} tasks in {processes} processes; {used}", soft_wrap=True)


def _drawn(table: "tuple[Task, ...]") -> Table:
    from vision_core.tasks.table import ALWAYS_READ

    drawn = Table("task", "released by", "priority", "budget", "process", "reads", "writes", box=None, pad_edge=False)
    for task in sorted(table, key=lambda task: -task.times.priority):
        own = [record for record in task.reads if record not in ALWAYS_READ]
        drawn.add_row(
            task.name if task.times.enabled else f"{task.name} (off)",
            _release(task),
            f"FIFO {task.times.priority}" if task.times.priority else "ordinary",
            f"{task.times.budget_ms:g} ms" if task.times.budget_ms else "-",
            task.process,
            " ".join(own),
            " ".join(task.writes),
        )
    return drawn


COUNTED = ("runs", "missed", "overruns", "Hz", "median ms", "max ms", "rehearsed", "cut short", "skipped", "spent s")
"""Columns of the live table that are numbers: since the task's start, but for rate and responses, which are recent."""


def _live(service: str) -> Table:
    """How every task of a running service runs, by its own newest report. Raises ServiceError."""
    from vision_core.clock import MonotonicClock
    from vision_core.net.control import attach_to
    from vision_core.rtdb import records

    attached, now = attach_to(service), MonotonicClock().now()
    drawn = Table("task", "policy", box=None, pad_edge=False)
    for column in COUNTED:
        drawn.add_column(column, justify="right")
    drawn.add_column("note")
    table = records.SERVICE.reader(attached.store).value(now).tasks
    for task in sorted(table, key=lambda task: -task.times.priority):
        timed = records.task(task.name).reader(attached.store).read(now)
        if timed is None:
            drawn.add_row(task.name, *[""] * (1 + len(COUNTED)), "has not reported yet", style="dim")
            continue
        late = "" if timed.valid else f"its newest report is {timed.age_s:.1f} s old; "
        drawn.add_row(
            *_reported(task.name, timed.value), f"{late}{timed.value.note}", style="" if timed.valid else "red"
        )
    return drawn


def _reported(name: str, info: "TaskInfo") -> tuple[str, ...]:
    own = (str(info.runs), str(info.missed), str(info.overruns), f"{info.rate_hz:.1f}")
    responses = (f"{info.response_median_ms:.2f}", f"{info.response_max_ms:.2f}")
    counts = info.rehearsals
    if counts is None:
        return (name, info.policy, *own, *responses, "-", "-", "-", "-")
    rehearsals = (str(counts.rehearsed), str(counts.cut_short), str(counts.skipped), f"{counts.spent_s:.1f}")
    return (name, info.policy, *own, *responses, *rehearsals)


def _release(task: "Task") -> str:
    """What releases a task, in words."""
    from vision_core.rtdb.task import DRIVER, NONE, PERIOD

    times = task.times
    period = f"every {times.period_ms:g} ms" if times.period_ms else ""
    if task.trigger == PERIOD:
        return f"{period} + {times.offset_ms:g}" if times.offset_ms else period
    trigger = {DRIVER: "its driver", NONE: "itself"}.get(task.trigger, task.trigger)
    return f"{trigger}, {period}" if period else trigger
