"""Baselines are built where there is a compiler, and the programs among them behave as what they are compared with."""

import itertools
import json
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

from bench.baselines import build

PERIOD_NS = 2_000_000
MESSAGE = "baselines in C are left out: no C compiler was found (no-such-compiler)"


def program_of(name: str) -> Path:
    program, message = build.build_program(name)
    if program is None:
        assert "no C compiler" in message
        pytest.skip(message)
    return program


def output_of(name: str, *arguments: object) -> dict[str, Any]:
    command = [str(program_of(name)), *map(str, arguments)]
    report: dict[str, Any] = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    return report


def test_a_missing_compiler_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(build, "COMPILERS", ("no-such-compiler",))
    assert build.build_program.__wrapped__("ring") == (None, MESSAGE)
    assert build.load_library.__wrapped__("udp_send") == (None, MESSAGE)


def test_a_file_that_does_not_compile_is_reported() -> None:
    program_of("ring")
    program, message = build.build_program("no_such_file")
    assert program is None
    assert message.startswith("no_such_file.c does not compile: ")


@pytest.mark.parametrize("name", ["activation", "handover", "ring"])
def test_wrong_arguments_are_refused(name: str) -> None:
    done = subprocess.run([str(program_of(name)), "7"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(f"{name}: 1 arguments")
    assert "accepted: " in done.stderr


@pytest.mark.parametrize("early_ns", [None, 200_000])
@pytest.mark.parametrize("priority", [0, 30])
def test_activation_never_wakes_before_its_release(priority: int, early_ns: int | None) -> None:
    early = () if early_ns is None else (time.monotonic_ns() + PERIOD_NS, early_ns)
    report = output_of("activation", PERIOD_NS, 30, priority, *early)
    wakes = report["wakes_ns"]
    assert len(wakes) == 30
    assert all(wake >= report["first_ns"] + k * PERIOD_NS for k, wake in enumerate(wakes))
    assert all(before < after for before, after in itertools.pairwise(wakes))
    assert (report["policy"] == "SCHED_FIFO") is (priority > 0 and report["refused"] != "SCHED_FIFO")


def test_activation_skips_releases_that_are_past() -> None:
    first = time.monotonic_ns() - 10 * PERIOD_NS
    report = output_of("activation", PERIOD_NS, 5, 0, first)
    assert report["skipped"] >= 10
    assert report["wakes_ns"][-1] >= first + 14 * PERIOD_NS


def test_handover_accounts_for_every_frame() -> None:
    report = output_of("handover", 200, 40, 300, 200)
    delivered = report["delivered_us"]
    assert len(delivered) == len(report["read_us"])
    assert len(delivered) + report["skipped"] + report["incomplete"] == report["published"] == 40
    assert all(latency_us >= 500.0 for latency_us in delivered)
    assert set(report["policies"]) == {"publish", "perceive", "serve", "receive"}
