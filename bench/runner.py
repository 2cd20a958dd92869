"""Runs benchmarks by name, and shows their results as one table or as lines of JSON.

A result is ``{"name", "value", "unit", "twin", "ratio", "goal", "met"}``: what was measured, what its twin
needed in the same run (a program of our own, a memcpy, the way before), value over twin, and the goal.
What does not apply is null.
"""

import json
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

Row = dict[str, Any]

BENCHMARKS = (
    *("accuracy", "segmentation", "loop", "views", "udp_send", "growing", "torn_reads", "scheduling"),
    *("activation", "handover", "dashboards", "gc_pauses", "clients", "faults"),
)
"""Modules of this package with a function ``run() -> list[Row]``, in the order in which all are run."""
KEYS = ("name", "value", "unit", "twin", "ratio", "goal", "met")
OUT = Path(__file__).with_name("out")
VERDICT = {True: "met", False: "NOT MET", None: ""}


def run(name: str) -> dict[str, Any]:
    """One benchmark: ``{"bench", "results"}``."""
    measure: Callable[[], list[Row]] = import_module(f"bench.{name}").run
    return {"bench": name, "results": [{key: row.get(key) for key in KEYS} for row in measure()]}


def run_all(names: tuple[str, ...], *, as_json: bool) -> None:
    """Run benchmarks one after the other and print each as soon as it is done; all without a name.

    The table also goes to ``bench/out/results.md`` when all were run.
    """
    tables = []
    for name in names or BENCHMARKS:
        done = run(name)
        tables.append(done)
        print(json.dumps(done) if as_json else "\n".join(_lines(done)), flush=True)
    if not names:
        OUT.mkdir(exist_ok=True)
        (OUT / "results.md").write_text("\n".join(_markdown(tables)) + "\n", encoding="utf-8")


def _lines(done: dict[str, Any]) -> Iterator[str]:
    yield f"\n{done['bench']:<56} {'value':>12} {'':<8} {'twin':>12} {'ratio':>7}  goal"
    for row in done["results"]:
        name, value, unit, twin, ratio, goal, verdict = _cells(row)
        yield f"  {name:<54} {value:>12} {unit:<8} {twin:>12} {ratio:>7}  {goal} {verdict}".rstrip()


def _markdown(tables: list[dict[str, Any]]) -> Iterator[str]:
    yield "| benchmark | what | value | unit | twin | ratio | goal | |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for done in tables:
        for row in done["results"]:
            yield f"| {done['bench']} | {' | '.join(_cells(row))} |"


def _cells(row: Row) -> tuple[str, ...]:
    numbers = [_text(row[key]) for key in ("value", "unit", "twin", "ratio", "goal")]
    return (str(row["name"]), *numbers, VERDICT[row["met"]])


def _text(value: object) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
