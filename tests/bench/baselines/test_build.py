"""Twins are built where there is a compiler; the programs among them keep the laws that they are compared by."""

import itertools
import json
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

from bench.baselines import build

PERIOD_NS = 2_000_000


def program_of(name: str) -> Path:
    program, word = build.build_program(name)
    if program is None:
        assert "no C compiler" in word
        pytest.skip(word)
    return program


def said_by(name: str, *arguments: object) -> dict[str, Any]:
    command = [str(program_of(name)), *map(str, arguments)]
    told: dict[str, Any] = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    return told


def test_no_compiler_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(build, "COMPILERS", ("no-such-compiler",))
    assert build.build_program.__wrapped__("ring") == (None, "no C compiler (no-such-compiler): twins skipped")
    assert build.load_twin.__wrapped__("fanout") == (None, "no C compiler (no-such-compiler): twins skipped")


def test_what_does_not_compile_is_said() -> None:
    program_of("ring")
    program, word = build.build_program("no_such_file")
    assert program is None
    assert word.startswith("no_such_file.c does not compile: ")


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
    told = said_by("activation", PERIOD_NS, 30, priority, *early)
    wakes = told["wakes_ns"]
    assert len(wakes) == 30
    assert all(wake >= told["first_ns"] + k * PERIOD_NS for k, wake in enumerate(wakes))
    assert all(before < after for before, after in itertools.pairwise(wakes))
    assert (told["policy"] == "SCHED_FIFO") is (priority > 0 and told["refused"] != "SCHED_FIFO")


def test_activation_skips_what_is_past() -> None:
    first = time.monotonic_ns() - 10 * PERIOD_NS
    told = said_by("activation", PERIOD_NS, 5, 0, first)
    assert told["skipped"] >= 10
    assert told["wakes_ns"][-1] >= first + 14 * PERIOD_NS


def test_handover_accounts_for_every_frame() -> None:
    told = said_by("handover", 200, 40, 300, 200)
    whole = told["delivered_us"]
    assert len(whole) == len(told["read_us"])
    assert len(whole) + told["skipped"] + told["incomplete"] == told["published"] == 40
    assert all(latency_us >= 500.0 for latency_us in whole)
    assert set(told["policies"]) == {"publish", "perceive", "serve", "receive"}
