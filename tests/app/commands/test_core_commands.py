"""The commands of the real-time core, as somebody at a terminal has them."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import app
from vision_core.errors import ServiceError, SettingsError

RUNNER = CliRunner()


def test_the_table_shows_every_task_and_that_it_is_in_order() -> None:
    done = RUNNER.invoke(app, ["tasks"])
    assert done.exit_code == 0, done.output
    lines = {line.split()[0]: line for line in done.output.splitlines() if line.strip()}
    assert "FIFO 45" in lines["perceive"]
    assert "every 400 ms + 37" in lines["lines"]
    assert "watch" in lines["colors"]
    assert "ordinary" in lines["web"]
    assert "in order: 15 tasks in 9 processes" in done.output


def test_a_check_warns_and_refuses(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text('[tasks.lines]\npriority = 30\noffset_ms = 13.0\nprocess = "alone"\n')
    done = RUNNER.invoke(app, ["tasks", "--check", "--venue", str(venue)])
    assert done.exit_code == 0, done.output
    assert done.output.startswith("warning: boundary and lines have equal priority (30) and offset (13 ms)")
    venue.write_text("[tasks.lines]\nperiod_ms = 0.5\n")
    refused = RUNNER.invoke(app, ["tasks", "--check", "--venue", str(venue)])
    assert isinstance(refused.exception, SettingsError)
    assert "line 2: tasks.lines.period_ms; found: 0.5: an impossible rate" in str(refused.exception)


@pytest.mark.slow
def test_a_self_test_says_a_class_and_what_was_granted() -> None:
    done = RUNNER.invoke(app, ["selftest", "--seconds", "0.3", "--json"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.output)
    assert found["grade"] in "ABC"
    assert found["wakeups"] == 60
    assert 0.0 < found["lateness_median_us"] <= found["lateness_p99_us"] <= found["lateness_max_us"]
    assert bool(found["refused"]) == (not found["policy"].startswith("FIFO"))
    words = RUNNER.invoke(app, ["selftest", "--seconds", "0.1"]).output
    assert "wake-ups" in words
    assert "priority" in words


def test_top_names_a_service_that_is_not_there() -> None:
    done = RUNNER.invoke(app, ["top", "pslv/nowhere", "--once"])
    assert isinstance(done.exception, ServiceError)
    assert "pslv/nowhere" in str(done.exception)
