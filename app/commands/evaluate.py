"""``pslv evaluate``: recall and precision on pictures with truth files."""

import json
from collections.abc import Iterable, Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from app.commands.options import ConfigFile, Venue
from vision_core.errors import SourceError

if TYPE_CHECKING:
    from vision_core.evaluation.cross_light import Pair
    from vision_core.evaluation.lights import LightScore
    from vision_core.evaluation.score import PictureScore, Score

T = TypeVar("T")


def evaluate(
    truth: Annotated[Path, typer.Argument(help="JSON file; its pictures lie relative to it.")],
    venue: Venue = None,
    config: ConfigFile = None,
    tolerance: Annotated[float, typer.Option(min=0.1, help="Largest distance of a right one [px].")] = 15.0,
    only: Annotated[str | None, typer.Option(help="Pictures whose names match: '30.01*'.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The sums as one line of JSON.")] = False,
    draw: Annotated[Path | None, typer.Option(help="Folder for overlays with misses marked.")] = None,
    lights: Annotated[bool, typer.Option("--lights", help="Score robots in other light instead.")] = False,
    cross_light: Annotated[
        bool, typer.Option("--cross-light", help="Find colors in each picture, and try them on all others, instead.")
    ] = False,
) -> None:
    """Score what is found in pictures against their truth: recall, precision and distance of robots and balls."""
    from vision_core.evaluation.cross_light import score_across, summary
    from vision_core.evaluation.lights import LIGHTS, score_in_lights
    from vision_core.evaluation.score import evaluate as score_all
    from vision_core.evaluation.score import total
    from vision_core.evaluation.truth_files import load_truth
    from vision_core.venues.loader import load_settings

    settings = load_settings(venue, config)
    pictures = load_truth(truth)
    chosen = [picture for picture in pictures if only is None or fnmatch(picture.file.name, only)]
    if not chosen:
        names = ", ".join(picture.file.name for picture in pictures[:5])
        raise SourceError(f"--only {only}", found="no picture of this name", accepted=f"names as {names}")
    if lights:
        in_lights = _tracked(score_in_lights(chosen, settings, tolerance), len(LIGHTS))
        _print_lights(in_lights, as_json=as_json)
        return
    if cross_light:
        pairs = _tracked(score_across(chosen, settings, tolerance), len(chosen) * (len(chosen) - 1))
        _print_across(pairs, summary(pairs), as_json=as_json)
        return
    scores = _tracked(score_all(chosen, settings, tolerance, draw), len(chosen))
    sums = total(scores)
    if as_json:
        typer.echo(json.dumps(sums))
    else:
        _print(scores, sums)


def _tracked(work: Iterable[T], total: int) -> list[T]:
    """All results, with a progress bar on a terminal."""
    console = Console(stderr=True, highlight=False)
    return list(track(work, total=total, console=console, transient=True, disable=not console.is_terminal))


def _print_lights(scores: Sequence["LightScore"], *, as_json: bool) -> None:
    if as_json:
        typer.echo(json.dumps([score.row() for score in scores]))
        return
    table = Table("light", "robots found", "ids right", "ids wrong", "false robots", expand=False)
    for one in scores:
        found, right = f"{one.found}/{one.robots}", f"{one.right}/{one.ids}"
        table.add_row(one.light, found, right, str(one.wrong), str(one.false))
    Console(highlight=False).print(table)


def _print_across(pairs: Sequence["Pair"], sums: Sequence[dict[str, Any]], *, as_json: bool) -> None:
    if as_json:
        typer.echo(json.dumps({"pairs": [pair.row() for pair in pairs], "summary": sums}))
        return
    table = Table("mode", "pairs", "found mean", "worst", "ids right mean", "worst", "ids wrong", "false", expand=False)
    for row in sums:
        shares = (_number(row[key]) for key in ("found_mean", "found_worst", "right_mean", "right_worst"))
        table.add_row(row["mode"], str(row["pairs"]), *shares, f"{row['wrong']}/{row['ids']}", str(row["false"]))
    Console(highlight=False).print(table)


def _print(scores: Sequence["PictureScore"], sums: dict[str, Any]) -> None:
    out = Console(highlight=False)
    table = Table("picture", "robots", "balls", "missed", "false", "reasons", expand=False)
    for score in scores:
        table.add_row(
            score.file.name,
            _share(score.robots),
            _share(score.balls),
            _places(score.missed),
            _places(score.false),
            "\n".join(score.reasons) if score.missed or score.false else "",
        )
    out.print(table)
    for kind in ("robots", "balls", "all"):
        recall, precision, rms = (_number(sums[kind][key]) for key in ("recall", "precision", "rms_px"))
        out.print(f"{kind:7} recall {recall}  precision {precision}  rms {rms} px  n {sums[kind]['n']}")
    out.print(f"wrong ids: {sums['wrong_id']}")


def _share(score: "Score") -> str:
    return f"{score.hits}/{score.true}"


def _places(things: list[tuple[str, float, float]]) -> str:
    return "\n".join(f"{name} ({x:.0f}, {y:.0f})" for name, x, y in things)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"
