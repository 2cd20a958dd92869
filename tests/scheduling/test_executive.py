"""The loop of a process: releases, proposals while it runs, and what it tells. Nothing is timed, only counted."""

import json
import subprocess
import sys
from typing import Any

import pytest

from tests.conftest import ROOT
from tests.scheduling.tables import line
from vision_core.rtdb.infos import TaskOverride
from vision_core.rtdb.task import PERIOD
from vision_core.scheduling.executive import with_override
from vision_core.settings.schema import TaskTimes

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def ran() -> dict[str, Any]:
    """An executive's life of a second and a half, in a process of its own."""
    command = [sys.executable, "-m", "tests.scheduling.executive_process"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_a_record_releases_a_task_and_its_readers_every_time(ran: dict[str, Any]) -> None:
    first, off, again, *_ = ran["counts"]["eyes"]
    assert 1 <= first <= 10
    assert off <= 1  # the override may come after the first image
    assert 1 <= again <= 10
    assert ran["heard"] == sum(ran["counts"]["eyes"])


def test_what_a_task_releases_in_its_process_runs_next(ran: dict[str, Any]) -> None:
    order, eyes = ran["order"], [place for place, name in enumerate(ran["order"]) if name == "eyes"]
    alone = [place for place in eyes if order[place + 1] != "ears"]
    assert len(eyes) - len(alone) == order.count("ears") > 0
    for place in alone:  # only a task of higher priority comes between
        assert order[place + 1] in ("idle", "slow", "eyes")


def test_a_period_follows_an_override_and_its_end(ran: dict[str, Any]) -> None:
    declared, faster, again, *_ = ran["counts"]["slow"]
    assert faster > declared
    assert faster > again
    assert ran["told"]["slow"]["times"]["period_ms"] == 40.0


def test_every_task_reports(ran: dict[str, Any]) -> None:
    eyes, slow = ran["told"]["eyes"], ran["told"]["slow"]
    assert (eyes["trigger"], eyes["times"]["enabled"], eyes["process"]) == ("images", True, "p")
    assert eyes["overruns"] == eyes["runs"] > 0  # no run takes less than its budget of a nanosecond
    assert slow["overruns"] == 0
    assert slow["interval_mean_ms"] > 0.0
    assert slow["policy"] in ("FIFO 3", "ordinary") or slow["policy"].startswith("nice")
    assert bool(slow["refusals"]) == (not slow["policy"].startswith("FIFO"))


def test_a_run_with_nothing_to_do_does_not_count(ran: dict[str, Any]) -> None:
    assert sum(ran["counts"]["idle"]) > 0
    assert ran["told"]["idle"]["runs"] == 0


def test_an_override_changes_what_it_names() -> None:
    task = line("t", PERIOD, (), (), "t", priority=3, period_s=0.1)
    assert with_override(task, TaskOverride()) == task
    changed = with_override(task, TaskOverride(enabled=False, period_ms=20.0, priority=0))
    assert changed.times == TaskTimes(priority=0, period_ms=20.0, budget_ms=0.0, enabled=False)
