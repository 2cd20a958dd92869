"""Results have every key; every benchmark can be imported and says what it measures."""

import json
import re
import sys
from importlib import import_module
from pathlib import Path

import pytest

import bench
from bench import accuracy, fidelity, runner
from bench.__main__ import main

IS_BENCHMARK = re.compile(r"^def run\([^)]*\) -> list\[Row\]", re.MULTILINE)


def test_a_result_has_every_key(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    rows = [
        {"name": "speed", "value": 1.5, "unit": "us", "baseline": 3.0, "ratio": 0.5, "goal": "<= 0.4x", "met": False},
        {"name": "count", "value": 7, "unit": ""},
    ]
    monkeypatch.setattr(accuracy, "run", lambda: rows)
    runner.run_all(("accuracy",), as_json=True)
    printed = json.loads(capsys.readouterr().out)
    assert printed["bench"] == "accuracy"
    assert [list(row) for row in printed["results"]] == [list(runner.KEYS)] * 2
    assert printed["results"][1]["met"] is None
    runner.run_all(("accuracy",), as_json=False)
    assert "NOT MET" in capsys.readouterr().out


def test_a_number_of_worlds_reaches_only_what_counts_worlds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(accuracy, "run", lambda: [{"name": "frames", "value": 1}])
    monkeypatch.setattr(fidelity, "run", lambda worlds: [{"name": "worlds", "value": worlds}])
    runner.run_all(("accuracy", "fidelity"), as_json=True, worlds=7)
    values = [json.loads(line)["results"][0]["value"] for line in capsys.readouterr().out.splitlines()]
    assert values == [1, 7]


@pytest.mark.parametrize("name", runner.BENCHMARKS)
def test_every_benchmark_can_be_run(name: str) -> None:
    assert callable(import_module(f"bench.{name}").run)


def test_every_benchmark_is_listed() -> None:
    """None can be written and not be run: a module whose ``run`` gives rows is one."""
    modules = Path(bench.__file__).parent.glob("*.py")
    assert {each.stem for each in modules if IS_BENCHMARK.search(each.read_text(encoding="utf-8"))} == set(
        runner.BENCHMARKS
    )


def test_help_lists_every_benchmark_with_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["bench", "--help"])
    with pytest.raises(SystemExit):
        main()
    printed = capsys.readouterr().out
    for name in runner.BENCHMARKS:
        summary = runner.summary_of(name)
        assert summary.endswith(".")
        assert f"{name} " in printed
        assert summary in printed
