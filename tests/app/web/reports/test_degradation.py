"""Degradation says what a person could put right, once, and never that the service is not ready."""

from dataclasses import replace

import pytest

from app.web.blackboard import Readings
from app.web.reports.degradation import degradations
from app.web.reports.readiness import reasons_not_ready
from tests.app.fake_readings import processes, readings, told
from tests.app.fake_tasks import Condition, self_test
from vision_core.venues.loader import load_settings

ALL = ("capture", "perceive", "serve", "boundary", "lines", "diagnose")


@pytest.fixture(scope="module")
def well() -> Readings:
    """A service of which every task has spoken."""
    return replace(readings(), tasks={name: told(name) for name in ALL})


def degraded(changed: Readings) -> tuple[str, ...]:
    """What is degraded while robots are served."""
    assert reasons_not_ready(changed) == ()
    return degradations(changed)


def test_a_service_that_has_all_it_wants_is_not_degraded(well: Readings) -> None:
    assert degraded(well) == ()


def test_equal_refusals_are_one_sentence_that_names_the_tasks(well: Readings) -> None:
    refused = {name: told(name, rights=False) for name in ("capture", "serve", "diagnose")}
    assert degraded(replace(well, tasks=refused)) == (
        "capture, serve: SCHED_FIFO 50, 40 is refused: no CAP_SYS_NICE, and ulimit -r is 0",
        "capture, serve: locking memory is refused: no CAP_IPC_LOCK, and ulimit -l is 8192 KiB",
    )


def test_a_refusal_may_hold_a_semicolon(well: Readings) -> None:
    cores = "cores 7 are refused: Invalid argument; there are 0, 1"
    alone = {"lines": told("lines", refused=f"SCHED_FIFO 20 is refused: Operation not permitted; {cores}")}
    assert degraded(replace(well, tasks=alone)) == (
        "lines: SCHED_FIFO 20 is refused: Operation not permitted",
        f"lines: {cores}",
    )


@pytest.mark.parametrize(
    ("p99_us", "sentence"),
    [
        (900.0, "this machine keeps time only fairly: class B, wake-ups are late by 0.9 ms at p99"),
        (3214.0, "this machine keeps time badly: class C, wake-ups are late by 3.2 ms at p99"),
    ],
)
def test_a_machine_that_keeps_time_badly(well: Readings, p99_us: float, sentence: str) -> None:
    assert degraded(replace(well, self_test=self_test(Condition(p99_us=p99_us)))) == (sentence,)


def test_processes_that_were_given_up_name_what_is_not_done(well: Readings) -> None:
    ends = "5 ends within a minute"
    states = {"watch": ("disabled", ends), "obstacles": ("disabled", ends), "spare-1": ("disabled", "")}
    assert degraded(replace(well, processes=processes(**states), tasks={})) == (
        f"process obstacles is disabled: {ends}",
        f"process watch is disabled, and with it boundary, lines, exposure, colors: {ends}",
        "process spare-1 is disabled",
    )


def test_what_starts_again_is_not_told(well: Readings) -> None:
    assert degraded(replace(well, processes=processes(watch=("restarting", "ended with signal SIGKILL")))) == ()


def test_a_needed_process_is_for_readiness_to_tell(well: Readings) -> None:
    broken = replace(well, processes=processes(serve=("disabled", "")))
    assert degradations(broken) == ()
    assert reasons_not_ready(broken) == ("process serve is disabled",)


def test_a_task_that_somebody_switched_off(well: Readings) -> None:
    off = replace(well, tasks={"lines": told("lines", enabled=False)})
    assert degraded(off) == ("task lines is switched off",)
    venue = load_settings(options={"tasks.lines.enabled": False})
    assert degraded(replace(off, service=replace(off.service, settings=venue))) == (), "its table wants it so"
