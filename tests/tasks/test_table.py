"""The built-in task table passes its checks, and mistakes in a venue's table are reported with file and line."""

from pathlib import Path

import msgspec
import pytest

from vision_core.errors import SettingsError
from vision_core.scheduling.checks import problems, warnings
from vision_core.settings.schema import TaskTimes
from vision_core.tasks.table import GIVEN, check_table, record_specs, task_table
from vision_core.venues.loader import layers_of, load_settings, place_of, settings_from_layers

DEVICE = load_settings(options={"source.uri": "camera:0"})


@pytest.mark.parametrize("settings", [load_settings(), DEVICE], ids=["simulated", "device"])
def test_the_built_in_table_has_no_problems_and_no_warnings(settings: object) -> None:
    assert isinstance(settings, type(DEVICE))
    table = task_table(settings)
    assert problems(table, GIVEN, settings.camera.rate_hz) == []
    assert warnings(table) == []


def test_every_record_of_the_table_has_a_spec() -> None:
    settings = load_settings()
    tasks = task_table(settings)
    specs = {spec.name for spec in record_specs(settings, tasks, ["a", "b"])}
    for task in tasks:
        assert {*task.reads, *task.writes, f"task/{task.name}", f"timing/{task.name}"} <= specs
    assert {"heartbeat/a", "heartbeat/b"} <= specs


def test_with_a_camera_device_there_is_no_task_source() -> None:
    assert "source" not in {task.name for task in task_table(DEVICE)}


def check(tmp_path: Path, text: str) -> str:
    """The error that the check of a venue's table raises; text: the venue file."""
    venue = tmp_path / "venue.toml"
    venue.write_text(text)
    layers = layers_of(str(venue))
    with pytest.raises(SettingsError) as said:
        check_table(settings_from_layers(layers), lambda key: place_of(key, layers))
    return str(said.value).replace(str(tmp_path), "")


OWN = 'priority = 1\nperiod_ms = 100.0\nbudget_ms = 1.0\nmodule = "m"\n'


def test_a_mistake_is_reported_with_its_file_and_line(tmp_path: Path) -> None:
    said = check(tmp_path, f"[camera]\nrate_hz = 25.0\n[tasks.mine]\n{OWN}writes = ['world']\n")
    assert said == (
        "/venue.toml, line 8: tasks.mine.writes; found: world, which serve writes; accepted: one writer for a record"
    )
    assert "/venue.toml, line 2: tasks.lines.offset_ms; found: 400 at" in check(
        tmp_path, "[tasks.lines]\noffset_ms = 400.0\n"
    )
    assert "/venue.toml, line 1: tasks.ghost; found: no task of this name" in check(
        tmp_path, "[tasks.ghost]\npriority = 1\nperiod_ms = 1.0\nbudget_ms = 0.0\n"
    )
    assert "default.toml, line" in check(tmp_path, "[camera]\nrate_hz = 900.0\n")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[tasks.web]\nprocess = "page"\n', "tasks.web.process; found: page; accepted: a process of its own"),
        (f"[tasks.compile]\n{OWN}", "tasks.compile; found: compile; accepted: another name"),
    ],
)
def test_reserved_names_of_processes_are_refused(tmp_path: Path, text: str, said: str) -> None:
    assert said in check(tmp_path, text)


def test_a_users_own_task_is_in_the_table_and_has_its_record(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(f"[tasks.mine]\n{OWN}reads = ['world']\nwrites = ['lab/mine']\n")
    settings = load_settings(str(venue))
    check_table(settings, str)
    mine = next(task for task in task_table(settings) if task.name == "mine")
    assert (mine.trigger, mine.process, mine.times.priority, mine.times.period_s) == ("period", "mine", 1, 0.1)
    assert "lab/mine" in {spec.name for spec in record_specs(settings, task_table(settings), [])}


def test_a_watcher_without_settings_runs_once_a_second_without_real_time_priority() -> None:
    settings = load_settings()
    others = {name: line for name, line in settings.tasks.items() if name != "lines"}
    table = {task.name: task for task in task_table(msgspec.structs.replace(settings, tasks=others))}
    assert table["lines"].times == TaskTimes(priority=0, period_ms=1000.0, budget_ms=0.0)
    assert table["lines"].process == "lines"
