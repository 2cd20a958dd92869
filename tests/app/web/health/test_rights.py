"""Refused rights are one cause for all tasks that they are refused to."""

from dataclasses import replace

import pytest

from app.web.blackboard import ServiceSnapshot
from app.web.health.rights import right_degradations
from tests.app.fake_snapshot import serving_snapshot, task_report, timed, with_records
from tests.app.fake_tasks import Condition, self_test
from vision_core.rtdb.infos import Refusal, RefusalKind

ALL = ("capture", "perceive", "serve", "boundary", "lines", "diagnose")
LATE = "views may be late when this machine is busy"


@pytest.fixture(scope="module")
def well() -> ServiceSnapshot:
    """A service of which every task has reported."""
    return replace(serving_snapshot(), tasks={name: task_report(name) for name in ALL})


def sentences(snapshot: ServiceSnapshot) -> list[str]:
    return [cause.sentence for cause in right_degradations(snapshot)]


def test_a_service_that_has_all_rights_is_not_degraded(well: ServiceSnapshot) -> None:
    assert sentences(well) == []


def test_equal_refusals_are_one_cause_that_names_the_tasks(well: ServiceSnapshot) -> None:
    refused = {name: task_report(name, rights=False) for name in ("capture", "serve", "diagnose")}
    assert sentences(replace(well, tasks=refused)) == [
        f"{LATE}: capture, serve: SCHED_FIFO 50, 40 is refused: no CAP_SYS_NICE, and ulimit -r is 0",
        f"{LATE}: capture, serve: locking memory is refused: no CAP_IPC_LOCK, and ulimit -l is 8192 KiB",
    ]


def test_a_refusal_may_hold_a_semicolon(well: ServiceSnapshot) -> None:
    cores = Refusal(RefusalKind.CORES, "7", "Invalid argument; there are cores 0, 1")
    priority = Refusal(RefusalKind.PRIORITY, "20", "Operation not permitted")
    assert sentences(replace(well, tasks={"lines": task_report("lines", refusals=(priority, cores))})) == [
        f"{LATE}: lines: SCHED_FIFO 20 is refused: Operation not permitted",
        f"{LATE}: lines: running on cores 7 is refused: Invalid argument; there are cores 0, 1",
    ]


@pytest.mark.parametrize(
    ("p99_us", "sentence"),
    [
        (900.0, "this machine keeps time only fairly: class B, wake-ups are late by 0.9 ms at p99"),
        (3214.0, "this machine keeps time badly: class C, wake-ups are late by 3.2 ms at p99"),
    ],
)
def test_a_machine_that_keeps_time_badly(well: ServiceSnapshot, p99_us: float, sentence: str) -> None:
    assert sentences(with_records(well, selftest=timed(self_test(Condition(p99_us=p99_us))))) == [sentence]
