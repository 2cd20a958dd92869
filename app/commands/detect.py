"""``pslv detect``: robots and balls in pictures from files."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from app.commands.options import ConfigFile, Venue


def detect(
    files: Annotated[list[Path], typer.Argument(help="Pictures, each judged alone.")],
    venue: Venue = None,
    config: ConfigFile = None,
    as_json: Annotated[bool, typer.Option("--json", help="One line of JSON per picture.")] = False,
    draw: Annotated[
        Path | None, typer.Option(help="Folder for overlays: what was found, and the color class of every pixel.")
    ] = None,
) -> None:
    """Find robots and balls in pictures; exit status 2 when one of the pictures cannot be read."""
    from vision_core.evaluation.stills import detect_files
    from vision_core.venues.loader import load_settings

    failed = False
    for found in detect_files(files, load_settings(venue, config), draw):
        failed |= "error" in found
        typer.echo(json.dumps(found) if as_json else _summary(found))
    if failed:
        raise typer.Exit(2)


def _summary(found: dict[str, Any]) -> str:
    """One picture's result in words."""
    if "error" in found:
        return f"{found['file']}: {found['error']}"
    robots = ", ".join(
        f"{robot['team']} {'?' if robot['id'] is None else robot['id']} ({robot['x_m']:.2f}, {robot['y_m']:.2f})"
        for robot in found["robots"]
    )
    balls = ", ".join(f"({ball['x_m']:.2f}, {ball['y_m']:.2f})" for ball in found["balls"])
    reasons = "".join(f"\n  {reason}" for reason in found["reasons"])
    return f"{found['file']}: robots: {robots or 'none'}; balls: {balls or 'none'}{reasons}"
