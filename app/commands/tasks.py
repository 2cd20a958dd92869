"""``pslv tasks``: the task table, and whether it is sound."""

import os
import sys
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from app.commands.options import ConfigFile, Venue
from vision_core.models.camera_setup import CameraSetup

if TYPE_CHECKING:
    from vision_core.rtdb.task import Task


def tasks(
    venue: Venue = None,
    config: ConfigFile = None,
    check: Annotated[bool, typer.Option("--check", help="Say whether it is sound; exit status 2 if not.")] = False,
) -> None:
    """Print the task table: what runs when, at which priority, and what it reads and writes."""
    from vision_core.scheduling.checks import load, warnings
    from vision_core.tasks.table import check_table, task_table
    from vision_core.venues.loader import layers_of, place_of, settings_from_layers

    layers = layers_of(venue, config)
    settings = settings_from_layers(layers)
    table, rate_hz = task_table(settings), CameraSetup.from_settings(settings).rate_hz
    out = Console(highlight=False, width=None if sys.stdout.isatty() else 200)
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


def _release(task: "Task") -> str:
    """What releases a task, in words."""
    from vision_core.rtdb.task import DRIVER, NONE, PERIOD

    times = task.times
    period = f"every {times.period_ms:g} ms" if times.period_ms else ""
    if task.trigger == PERIOD:
        return f"{period} + {times.offset_ms:g}" if times.offset_ms else period
    trigger = {DRIVER: "its driver", NONE: "itself"}.get(task.trigger, task.trigger)
    return f"{trigger}, {period}" if period else trigger
