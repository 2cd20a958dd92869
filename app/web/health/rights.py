"""Causes of worse service: rights that the operating system refuses, a machine that wakes processes late."""

from collections.abc import Iterator

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Cause, Subject
from vision_core.clock import US_PER_MS
from vision_core.rtdb import records
from vision_core.rtdb.infos import Refusal, RefusalKind

GRADES = {"B": "only fairly", "C": "badly"}
"""How well a machine keeps time that is not of class A."""
GRANTED_BY = {
    RefusalKind.PRIORITY: "Start as root, add CAP_SYS_NICE, or allow rtprio 95 in /etc/security/limits.conf.",
    RefusalKind.MEMORY: "Start as root, add CAP_IPC_LOCK, or allow unlimited memlock in /etc/security/limits.conf.",
    RefusalKind.CORES: "Choose cores that this computer has, as cores of the task in the venue's file.",
}
"""What to do when the kernel refuses something."""


def right_degradations(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """Refused rights, once for all tasks to which they are refused, and the grade of the self-test."""
    yield from _refusals(snapshot)
    test = snapshot.of(records.SELF_TEST)
    if test and test.value.grade in GRADES:
        grade, late_ms = test.value.grade, test.value.lateness_p99_us / US_PER_MS
        yield Cause(
            "self-test",
            Subject.MACHINE,
            f"this machine keeps time {GRADES[grade]}",
            "Close other programs, switch power saving off, or use a computer with a real-time kernel.",
            f"class {grade}, wake-ups are late by {late_ms:.2g} ms at p99",
        )


def _refusals(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    same: dict[tuple[RefusalKind, str], list[tuple[str, str]]] = {}
    for name, timed in snapshot.tasks.items():
        for refusal in timed.value.refusals:
            same.setdefault((refusal.kind, refusal.why), []).append((name, refusal.asked))
    for (kind, why), refused in same.items():
        names = ", ".join(name for name, _ in refused)
        asked = ", ".join(dict.fromkeys(asked for _, asked in refused))
        text = "views may be late when this machine is busy"
        detail = f"{names}: {Refusal(kind, asked, why)}"
        yield Cause(f"refused {kind} {why}", Subject.MACHINE, text, GRANTED_BY[kind], detail)
