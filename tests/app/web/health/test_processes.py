"""Processes that are disabled or crash again and again are causes of worse service."""

from dataclasses import replace

import pytest

from app.web.blackboard import ServiceSnapshot
from app.web.health.processes import RESTART_HOLD_S, process_degradations
from tests.app.fake_snapshot import processes, serving_snapshot, task_report, with_records
from vision_core.rtdb.infos import TaskOverride
from vision_core.tasks.table import task_table
from vision_core.venues.loader import load_settings


@pytest.fixture(scope="module")
def well() -> ServiceSnapshot:
    """A service that serves."""
    return serving_snapshot()


def sentences(snapshot: ServiceSnapshot) -> list[str]:
    return [cause.sentence for cause in process_degradations(snapshot)]


def test_processes_that_run_are_no_cause(well: ServiceSnapshot) -> None:
    assert sentences(well) == []


def test_disabled_processes_name_the_tasks_that_are_not_done(well: ServiceSnapshot) -> None:
    ends = "5 ends within a minute"
    states = {"watch": ("disabled", ends), "obstacles": ("disabled", ends), "spare-1": ("disabled", "")}
    given_up = "a part of the service has been given up"
    assert sentences(with_records(well, processes=processes(**states))) == [
        f"{given_up}: process obstacles is disabled: {ends}",
        f"{given_up}: process watch is disabled: {ends} (boundary, lines, exposure, colors)",
        f"{given_up}: process spare-1 is disabled",
    ]


@pytest.mark.parametrize("state", ["restarting", "starting"])
def test_a_process_that_restarts_is_a_cause_when_it_lasts(well: ServiceSnapshot, state: str) -> None:
    table = processes(watch=(state, "ended with signal SIGKILL"))
    again = tuple(replace(row, restarts=1) if row.name == "watch" else row for row in table.value.processes)
    restarted = replace(table, value=replace(table.value, processes=again))
    (cause,) = process_degradations(with_records(well, processes=restarted))
    assert cause.hold_s == RESTART_HOLD_S
    assert cause.text == "a part of the service keeps crashing"
    assert cause.detail.startswith(f"process watch is {state}: ended with signal SIGKILL")


def test_a_process_that_starts_for_the_first_time_is_no_cause(well: ServiceSnapshot) -> None:
    assert sentences(with_records(well, processes=processes(watch=("starting", "")))) == []


def test_what_is_compiled_while_robots_are_served_names_the_tasks_that_wait(well: ServiceSnapshot) -> None:
    states = {"compile_others": ("running", "0 of 1 parts are compiled"), "diagnose": ("waiting", "")}
    (sentence,) = sentences(with_records(well, processes=processes(**states)))
    assert sentence == (
        "a first start: what explains and watches is still compiled: 0 of 1 parts are compiled;"
        " these tasks wait: search, diagnose, overlay"
    )


@pytest.mark.parametrize("name", ["source", "capture", "perceive", "serve", "compile"])
def test_a_needed_process_belongs_to_readiness(well: ServiceSnapshot, name: str) -> None:
    assert sentences(with_records(well, processes=processes(**{name: ("disabled", "")}))) == []


def test_a_task_that_was_switched_off_is_a_cause_unless_the_venue_has_it_so(well: ServiceSnapshot) -> None:
    off = replace(well, tasks={"lines": task_report("lines", TaskOverride(enabled=False))})
    assert sentences(off) == ["task lines is switched off"]
    tasks = task_table(load_settings(options={"tasks.lines.enabled": False}))
    assert sentences(replace(off, service=replace(off.service, tasks=tasks))) == []
