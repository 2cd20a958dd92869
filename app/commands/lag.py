"""``pslv lag``: the lag from the image to a program on this computer, in the parts of the paper's figure 8."""

import json as json_format
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from app.commands.options import robot_of
from vision_core.errors import PslvError

if TYPE_CHECKING:
    from vision_core.client import Connection, Lag
    from vision_core.geometry import Floats

PARTS = ("A server", "B network", "C program", "total")
COLORS = ((230, 150, 60), (110, 190, 90), (70, 150, 250))
PATIENCE_S = 5.0
SIZE_PX = 960, 420
MS_PER_S = 1000.0
SHOWN = (("median", 0.5), ("90 %", 0.9), ("99 %", 0.99), ("max", 1.0))


def lag(
    team: Annotated[str, typer.Option(help="blue or yellow.")],
    number: Annotated[int, typer.Option(min=1, max=16, help="A robot of which no program runs.")],
    host: Annotated[str, typer.Argument(help="Name or address of the server's computer.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(envvar="PSLV_UDP_PORT", min=1, max=65535, help="UDP port of the server.")] = 6000,
    seconds: Annotated[float, typer.Option(min=1.0, max=3600.0, help="How long to measure.")] = 10.0,
    key: Annotated[str, typer.Option(envvar="PSLV_KEY", help="The team's key, from the referee.")] = "",
    json: Annotated[bool, typer.Option("--json", help="Print every view's lags as a line of JSON.")] = False,
    picture: Annotated[Path | None, typer.Option(help="Draw A, B and C over time as a PNG picture.")] = None,
) -> None:
    """Measure the lags A (server), B (network) and C (program) of every view, as a robot's program on this computer.

    B and C are those of this computer and of a program that does nothing. `/api/v1/timing` and the page Timing have the
    lags that the robots' own programs report.
    """
    from vision_core.client import Options, connect

    name = f"{team} {number} at {host}"
    with connect(host, port, *robot_of(f"{team}:{number}"), options=Options(extras=("age",)), key=key) as connection:
        found = list(_measured(connection, seconds))
    if len(found) < 2:
        views = f"{len(found)} views with a lag"
        raise PslvError(f"lags of {name}", found=views, accepted=_wanted(connection))
    times_s, lags_ms = np.array([at for at, _ in found]), _milliseconds([each for _, each in found])
    if json:
        for at_s, row in zip(times_s.tolist(), lags_ms.tolist(), strict=True):
            names = ("a_ms", "b_ms", "c_ms", "total_ms")
            typer.echo(json_format.dumps({"time_s": at_s} | dict(zip(names, row, strict=True))))
    else:
        _print(lags_ms, max(each.bound_s for _, each in found))
    if picture is not None:
        _draw(picture, times_s, lags_ms, name)


def _measured(connection: "Connection", seconds: float) -> "Iterator[tuple[float, Lag]]":
    """Time and lag of each view, for so long from the first whose lag is known."""
    end = time.monotonic() + PATIENCE_S
    is_known = False
    view = connection.newest(PATIENCE_S)
    while view is not None and time.monotonic() < end:
        following = connection.newest(PATIENCE_S)
        if view.lag is not None and connection.lag is not None:
            if not is_known:
                is_known, end = True, time.monotonic() + seconds
            yield view.time_s, connection.lag
        view = following


def _wanted(connection: "Connection") -> str:
    if connection.facts is None:
        return "a server of version 2: this one does not tell its clock"
    return "a robot that the camera sees"


def _milliseconds(lags: "list[Lag]") -> "Floats":
    """A, B, C and total of each view [ms], shape (n, 4)."""
    rows = [(each.server_s, each.network_s, each.client_s, each.total_s) for each in lags]
    return np.array(rows) * MS_PER_S


def _print(lags_ms: "Floats", bound_s: float) -> None:
    table = Table(escape("lag [ms]"), *(name for name, _ in SHOWN), box=None)
    for column in table.columns[1:]:
        column.justify = "right"
    for part, values in zip(PARTS, lags_ms.T, strict=True):
        table.add_row(part, *(f"{np.quantile(values, share):.2f}" for _, share in SHOWN))
    console = Console(highlight=False)
    console.print(table)
    console.print(f"{len(lags_ms)} views; B is right within {bound_s * MS_PER_S:.2f} ms, A and C are exact")


def _draw(path: Path, times_s: "Floats", lags_ms: "Floats", name: str) -> None:
    """Draw figure 8. Raises SourceError."""
    from app.web.charts.layers import Layer, draw_layers
    from vision_core.native.opencv import write_picture

    medians = np.median(lags_ms, axis=0)
    layers = [
        Layer(f"{part}: {median:.2f} ms", values, color)
        for part, median, values, color in zip(PARTS[:3], medians[:3], lags_ms.T[:3], COLORS, strict=True)
    ]
    title = f"Lag of {name}: {medians[3]:.2f} ms in the median of {len(lags_ms)} views"
    write_picture(path, draw_layers(times_s - times_s[0], layers, title, ("time [s]", "lag [ms]"), SIZE_PX))
