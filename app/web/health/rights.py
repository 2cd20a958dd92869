"""Degradation by rights that the operating system refuses, and by a machine that wakes processes late."""

from collections.abc import Iterator

from app.web.blackboard import ServiceSnapshot
from app.web.health.degradation import Degradation
from vision_core.clock import US_PER_MS
from vision_core.rtdb import records
from vision_core.rtdb.infos import Refusal, RefusalKind

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
    same: dict[tuple[RefusalKind, str], list[tuple[str, str]]] = {}
    for name, timed in snapshot.tasks.items():
        for refusal in timed.value.refusals:
            same.setdefault((refusal.kind, refusal.why), []).append((name, refusal.asked))
    for (kind, why), refused in same.items():
        names = ", ".join(name for name, _ in refused)
        asked = ", ".join(dict.fromkeys(asked for _, asked in refused))
        text = "views may be late when this machine is busy"
        yield Degradation(f"refused {kind} {why}", text, f"{names}: {Refusal(kind, asked, why)}")
