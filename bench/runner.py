"""Runs benchmarks by name, and prints their results as tables or as lines of JSON.

A result is ``{"name", "value", "unit", "baseline", "ratio", "goal", "met"}``: what was measured; the value of the
baseline in the same run (a C program of our own, a memcpy, the service without the load, or the paper's figure); value
over baseline; the goal and whether it is met. What does not apply is null.
"""

import ast
import json
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

Row = dict[str, Any]

BENCHMARKS = (
    *("accuracy", "calibration", "mirror", "segmentation", "loop", "views", "udp_send", "send_stamps"),
    *("growing", "torn_reads", "fairness", "first_start"),
    *(
        "scheduling",
        "activation",
        "handover",
        "no_trace",
        "dashboards",
        "gc_pauses",
        "clients",
        "clock_sync",
        "floods",
        "fuzz",
        "light",
        "faults",
    ),
    *("onboard", "fidelity"),
)
"""Modules of this package with a function ``run() -> list[Row]``, in the order in which all are run."""
COUNT_WORLDS = ("fidelity",)
"""Those whose ``run`` takes a number of worlds."""
KEYS = ("name", "value", "unit", "baseline", "ratio", "goal", "met")
OUT = Path(__file__).with_name("out")
VERDICT = {True: "met", False: "NOT MET", None: ""}


def summary_of(name: str) -> str:
    """What a benchmark measures, in one line: the first of its docstring. The module is not imported."""
    source = Path(__file__).with_name(f"{name}.py").read_text(encoding="utf-8")
    return (ast.get_docstring(ast.parse(source)) or "").partition("\n")[0]


def run(name: str, worlds: int | None = None) -> dict[str, Any]:
    """Run one benchmark. Returns ``{"bench", "results"}``. worlds: how many, for one that counts random worlds."""
    measure: Callable[..., list[Row]] = import_module(f"bench.{name}").run
    rows = measure(worlds) if worlds is not None and takes_worlds(name) else measure()
    return {"bench": name, "results": [{key: row.get(key) for key in KEYS} for row in rows]}


def takes_worlds(name: str) -> bool:
    """Whether a benchmark can be told how many random worlds it shall count."""
    return name in COUNT_WORLDS


def run_all(names: tuple[str, ...], *, as_json: bool, worlds: int | None = None) -> None:
    """Run the named benchmarks, or all without a name, and print each as soon as it has finished.

    When all were run, the table is written to ``bench/out/results.md`` as well.
    """
    tables = []
    for name in names or BENCHMARKS:
        table = run(name, worlds)
        tables.append(table)
        print(json.dumps(table) if as_json else "\n".join(_lines(table)), flush=True)
    if not names:
        OUT.mkdir(exist_ok=True)
        (OUT / "results.md").write_text("\n".join(_markdown(tables)) + "\n", encoding="utf-8")


def _lines(table: dict[str, Any]) -> Iterator[str]:
    yield f"\n{table['bench']:<56} {'value':>12} {'':<8} {'baseline':>12} {'ratio':>7}  goal"
    for row in table["results"]:
        name, value, unit, baseline, ratio, goal, verdict = _cells(row)
        yield f"  {name:<54} {value:>12} {unit:<8} {baseline:>12} {ratio:>7}  {goal} {verdict}".rstrip()


def _markdown(tables: list[dict[str, Any]]) -> Iterator[str]:
    yield "| benchmark | what | value | unit | baseline | ratio | goal | |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for table in tables:
        for row in table["results"]:
            yield f"| {table['bench']} | {' | '.join(_cells(row))} |"


def _cells(row: Row) -> tuple[str, ...]:
    numbers = [_text(row[key]) for key in ("value", "unit", "baseline", "ratio", "goal")]
    return (str(row["name"]), *numbers, VERDICT[row["met"]])


def _text(value: object) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
