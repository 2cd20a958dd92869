"""What benchmarks print."""

import json
from importlib import import_module

import pytest

from bench import accuracy, runner


def test_a_result_has_every_key(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    rows = [
        {"name": "speed", "value": 1.5, "unit": "us", "twin": 3.0, "ratio": 0.5, "goal": "<= 0.4x", "met": False},
        {"name": "count", "value": 7, "unit": ""},
    ]
    monkeypatch.setattr(accuracy, "run", lambda: rows)
    runner.run_all(("accuracy",), as_json=True)
    said = json.loads(capsys.readouterr().out)
    assert said["bench"] == "accuracy"
    assert [list(row) for row in said["results"]] == [list(runner.KEYS)] * 2
    assert said["results"][1]["met"] is None
    runner.run_all(("accuracy",), as_json=False)
    assert "NOT MET" in capsys.readouterr().out


@pytest.mark.parametrize("name", runner.BENCHMARKS)
def test_every_benchmark_can_be_run(name: str) -> None:
    assert callable(import_module(f"bench.{name}").run)
