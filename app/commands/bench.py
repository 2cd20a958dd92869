"""``pslv bench``: the benchmarks of a checkout."""

from importlib.util import find_spec
from typing import Annotated

import typer

from vision_core.errors import PslvError


def bench(
    names: Annotated[list[str] | None, typer.Argument(help="Which; without a name all.")] = None,
    worlds: Annotated[int | None, typer.Option(min=1, help="How many random worlds fidelity counts.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="One line of JSON per benchmark.")] = False,
) -> None:
    """Measure every published figure, with its baseline in the same run; `python -m bench --help` lists them."""
    if find_spec("bench") is None:
        raise PslvError("pslv bench", found="an installed package", accepted="a checkout of the repository")
    from bench.runner import BENCHMARKS, run_all

    for name in names or ():
        if name not in BENCHMARKS:
            raise PslvError(f"pslv bench {name}", found="no such benchmark", accepted=", ".join(BENCHMARKS))
    run_all(tuple(names or ()), as_json=as_json, worlds=worlds)
