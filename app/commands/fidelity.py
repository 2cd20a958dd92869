"""``pslv fidelity``: the paper's figures of a random world, and how far the simulated view is the real one."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.commands.progress import Progress
from vision_core.errors import SettingsError

if TYPE_CHECKING:
    from vision_core.fidelity.experiment import Tally


def fidelity(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the pictures and numbers.json.")],
    field: Annotated[str, typer.Option(help="3 m or league.")] = "3 m",
    ceiling: Annotated[
        str, typer.Option(help="Size of the ceiling camera's picture: 640x480 or 1280x1024.")
    ] = "640x480",
    high: Annotated[bool, typer.Option("--high", help="Robots as high as the on-board camera's viewpoint.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of the world that is drawn; the first one of --worlds.")] = 0,
    worlds: Annotated[int, typer.Option(min=1, max=100_000, help="How many worlds the numbers count.")] = 1,
) -> None:
    """Draw figures 3, 4, 6 and 7 of the PSLV paper for a random world; count how far view and on-board picture agree.

    With --worlds, the one that agrees least is drawn too.
    """
    from vision_core.fidelity.demonstration import demonstrate
    from vision_core.fidelity.experiment import run
    from vision_core.fidelity.summary import numbers
    from vision_core.fidelity.worlds import CEILING_PX, FIELDS, ONBOARD_PX, Setup
    from vision_core.native.opencv import write_picture

    for name, asked, accepted in (("--field", field, FIELDS), ("--ceiling", ceiling, CEILING_PX)):
        if asked not in accepted:
            raise SettingsError(name, found=asked, accepted=", ".join(accepted))
    progress = Progress("fidelity")
    setup = Setup(field, ceiling, ONBOARD_PX[field], high)
    output.mkdir(parents=True, exist_ok=True)
    progress.show("figures")
    _, figures = demonstrate(setup, seed)
    tally = run(setup.field, setup.onboard_px, tall=high, seeds=range(seed, seed + worlds), show=progress.show,
                ceilings=(ceiling,))[ceiling]  # fmt: skip
    if worlds > 1 and tally.comparisons:
        worst = tally.worst().seed
        progress.show(f"world {worst}, which agrees least")
        figures["worst"] = demonstrate(setup, worst)[1]["disagreement"]
    progress.show("")
    for name, picture in figures.items():
        write_picture(output / f"{name}.png", picture)
    found = numbers(tally)
    (output / "numbers.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    typer.echo(_words(tally, found))
    typer.echo(f"{output}: {', '.join(f'{name}.png' for name in figures)}, numbers.json")


def _words(tally: "Tally", found: dict[str, Any]) -> str:
    """The result in a few lines."""
    many = "worlds" if tally.worlds > 1 else "world"
    lines = [f"{tally.worlds} {many} on the {tally.setup.field} field, ceiling camera {tally.setup.ceiling}"]
    if not tally.comparisons:
        return f"{lines[0]}: robot A is found in none"
    lines.append(f"  {found['same_type']:7.2%}  of directions: type alike, within one direction")
    lines.append(f"  {found['within_1_px']:7.2%}  of these: distance alike, within 1 px. The rest:")
    lines += [f"  {share:7.2%}  {cause}" for cause, share in found["causes"].items() if share]
    return "\n".join(lines)
