"""Degradation by rights that the operating system refuses, and by a machine that wakes processes late."""

import re
from collections.abc import Iterator

from app.web.blackboard import ServiceSnapshot
from app.web.health.degradation import Degradation
from vision_core.rtdb import records

REASONS = re.compile(r"; (?=[^;]*\brefused\b)")
"""Between two refusals in one sentence of a task."""
PRIORITY = re.compile(r"SCHED_FIFO (\d+)")
US_PER_MS = 1e3
GRADES = {"B": "only fairly", "C": "badly"}
"""How well a machine keeps time that is not of class A."""


def right_degradations(snapshot: ServiceSnapshot) -> Iterator[Degradation]:
    """Refused rights, once for all tasks to which they are refused, and the grade of the self-test."""
    yield from _refusals(snapshot)
    test = snapshot.of(records.SELF_TEST)
    if test and test.value.grade in GRADES:
        grade, late_ms = test.value.grade, test.value.lateness_p99_us / US_PER_MS
        yield Degradation(
            "self-test",
            f"this machine keeps time {GRADES[grade]}",
            f"class {grade}, wake-ups are late by {late_ms:.2g} ms at p99",
        )


def _refusals(snapshot: ServiceSnapshot) -> Iterator[Degradation]:
    tasks: dict[str, list[str]] = {}
    priorities: dict[str, list[str]] = {}
    for name, timed in snapshot.tasks.items():
        for refusal in filter(None, REASONS.split(timed.value.refused)):
            reason = PRIORITY.sub("SCHED_FIFO {}", refusal)
            tasks.setdefault(reason, []).append(name)
            priorities.setdefault(reason, []).extend(PRIORITY.findall(refusal))
    for reason, names in tasks.items():
        asked = ", ".join(dict.fromkeys(priorities[reason]))
        text = "views may be late when this machine is busy"
        yield Degradation(f"refused {reason}", text, f"{', '.join(names)}: {reason.replace('{}', asked)}")
