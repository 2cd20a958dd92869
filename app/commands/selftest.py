"""``pslv selftest``: how well this machine keeps time."""

import json
from dataclasses import asdict
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from app.commands.running import child_of_python

MEANINGS = {
    "A": "every camera can be served",
    "B": "fine at 30 frames a second",
    "C": "frames will be late when the machine has other work",
}


def selftest(
    seconds: Annotated[float, typer.Option(min=0.1, max=600.0, help="How long to measure.")] = 2.0,
    as_json: Annotated[bool, typer.Option("--json", help="As one line of JSON.")] = False,
) -> None:
    """Measure how late this machine wakes a real-time process, and what the kernel grants: class A, B or C."""
    import msgspec

    from vision_core.rtdb.infos import SelfTest
    from vision_core.scheduling import selftest as selftest_module

    printed = child_of_python(selftest_module.__name__, str(seconds))
    result = msgspec.json.decode(printed, type=SelfTest)
    if as_json:
        typer.echo(json.dumps(asdict(result)))
        return
    table = Table(show_header=False, box=None, pad_edge=False)
    late = f"{result.lateness_median_us:.0f} us median, {result.lateness_p99_us:.0f} us p99, "
    table.add_row("class", f"{result.grade}: {MEANINGS[result.grade]}")
    table.add_row("wake-ups", f"{result.wakeups}, every 5 ms; late by {late}{result.lateness_max_us:.0f} us at most")
    table.add_row("priority", f"{result.policy}{f': {result.refused}' if result.refused else ''}")
    table.add_row("memory", "locked" if result.memory_locked else result.memory_refused)
    Console(highlight=False).print(table)
