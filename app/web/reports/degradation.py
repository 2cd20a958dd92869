"""What is worse than it should be while robots are served: one pure function of what was read.

A service that is degraded is ready. What keeps it from being ready is said by ``app.web.reports.readiness`` alone.
"""

import re
from collections.abc import Iterator

from app.web.blackboard import Readings
from app.web.reports.readiness import COMPILER, NEEDED, process_of
from vision_core.rtdb.infos import SelfTest

REASONS = re.compile(r"; (?=[^;]*\brefused\b)")
"""Between two refusals in one sentence of a task."""
PRIORITY = re.compile(r"SCHED_FIFO (\d+)")
US_PER_MS = 1e3
GRADES = {"B": "only fairly", "C": "badly"}
"""How a machine keeps time that is not of class A."""


def degradations(readings: Readings) -> tuple[str, ...]:
    """Everything that a person could put right, in words; empty when all is well."""
    graded = _graded(readings.self_test) if readings.self_test else ()
    return (*_refusals(readings), *graded, *_disabled(readings), *_switched_off(readings))


def _refusals(readings: Readings) -> Iterator[str]:
    """What the kernel refused, once for all tasks that it refused it to."""
    tasks: dict[str, list[str]] = {}
    priorities: dict[str, list[str]] = {}
    for name, timed in readings.tasks.items():
        for refusal in filter(None, REASONS.split(timed.value.refused)):
            reason = PRIORITY.sub("SCHED_FIFO {}", refusal)
            tasks.setdefault(reason, []).append(name)
            priorities.setdefault(reason, []).extend(PRIORITY.findall(refusal))
    for reason, names in tasks.items():
        asked = ", ".join(dict.fromkeys(priorities[reason]))
        yield f"{', '.join(names)}: {reason.replace('{}', asked)}"


def _graded(machine: SelfTest) -> Iterator[str]:
    if machine.grade in GRADES:
        yield (
            f"this machine keeps time {GRADES[machine.grade]}: class {machine.grade}, "
            f"wake-ups are late by {machine.lateness_p99_us / US_PER_MS:.2g} ms at p99"
        )


def _disabled(readings: Readings) -> Iterator[str]:
    """Processes that were given up, and what is not done without them."""
    needed = {process_of(task, readings) for task in NEEDED}
    for process in readings.processes.value.processes if readings.processes else ():
        if process.state == "disabled" and process.name not in needed | {COMPILER}:
            names = [task for task in readings.task_names if process_of(task, readings) == process.name]
            without = f", and with it {', '.join(names)}" if names not in ([], [process.name]) else ""
            detail = f": {process.detail}" if process.detail else ""
            yield f"process {process.name} is disabled{without}{detail}"


def _switched_off(readings: Readings) -> Iterator[str]:
    """Tasks that the table has running."""
    for name, timed in readings.tasks.items():
        if name not in NEEDED and not timed.value.enabled and readings.service.settings.tasks[name].enabled:
            yield f"task {name} is switched off"
