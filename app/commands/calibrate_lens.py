"""``pslv calibrate board`` and ``pslv calibrate lens``: a board to print, and the lens from pictures of it."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.calibrate import own_file, read_pictures
from app.commands.options import ConfigFile, Venue
from app.commands.progress import Progress
from vision_core.errors import SettingsError

if TYPE_CHECKING:
    from vision_core.calibration.board.result import BoardPicture, LensCalibration


def board(
    out: Annotated[Path, typer.Option(help="The file to write: .pdf or .svg to print, .png for a flat screen.")],
    paper: Annotated[str, typer.Option(help="A4 or A3.")] = "A4",
) -> None:
    """Write a board from whose pictures `pslv calibrate lens` measures the camera's lens."""
    from vision_core.calibration.board.board import BOARDS
    from vision_core.calibration.board.sheet import write_board

    wanted = BOARDS.get(paper.upper())
    if wanted is None:
        raise SettingsError("--paper", found=paper, accepted=", ".join(BOARDS))
    write_board(wanted, out)
    typer.echo(f"{out}: squares of {wanted.square_mm:g} mm on {wanted.paper}; print at 100 %, measure both rulers")


def lens(
    pictures: Annotated[
        list[Path], typer.Argument(help="Pictures of a board near to the camera, tilted to several sides, all over it.")
    ],
    venue: Venue = None,
    config: ConfigFile = None,
    draw: Annotated[
        Path | None, typer.Option(help="Picture file: where boards were seen, and their corners' distances.")
    ] = None,
    save: Annotated[bool, typer.Option("--save", help="Write the lens into the file of --config or --venue.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Everything as one line of JSON.")] = False,
) -> None:
    """Measure the camera's lens by pictures of a board (`pslv calibrate board`), and print a venue's [camera.lens].

    With it `pslv calibrate camera` holds the lens, and the painted lines tell the pose and the height. A result that
    cannot be trusted is refused with its reasons, and exit status 2.
    """
    from vision_core.calibration.board.draw import draw_lens
    from vision_core.calibration.board.lens import calibrate_lens
    from vision_core.native.opencv import write_picture
    from vision_core.venues.camera_edit import lens_tables, lines_of, save_lens
    from vision_core.venues.loader import layers_of

    layers = layers_of(venue, config)
    target = own_file(venue, config, layers, is_needed=save)
    shown = read_pictures(pictures)
    progress = Progress("measuring the lens")
    try:
        result = calibrate_lens(
            shown,
            [path.name for path in pictures],
            progress=lambda what, share: progress.show(f"{share:.0%} {what}"),
        )
    finally:
        progress.show("")
    if draw is not None:
        write_picture(draw, draw_lens(result))
    typer.echo(_json(result) if as_json else _report(result))
    if not result.accepted or result.lens is None:
        raise typer.Exit(2)
    if not as_json:
        typer.echo(lines_of(lens_tables(result.lens)))
    if save and target is not None:
        save_lens(layers, target, result.lens)
        typer.echo(f"# saved in {target.name}", err=True)


def _json(result: "LensCalibration") -> str:
    import msgspec

    return json.dumps(msgspec.to_builtins(result))


def _report(result: "LensCalibration") -> str:
    """The verdict as comments of TOML."""
    least = min(result.regions, key=lambda name: result.regions[name])
    lines = [_line(picture) for picture in result.pictures]
    lines += [
        f"{result.rms_px:.2f} px rms over {result.corners} corners",
        f"boards covered {result.coverage:.0%} of the picture, of the {least} {result.regions[least]:.0%}",
        f"places in the picture are up to {result.bend_error_px:.2f} px off (two deviations)",
        f"condition number {result.condition:.2g}",
        *(f"note: {note}" for note in result.notes),
        *(f"refused: {reason}" for reason in result.reasons),
    ]
    return "\n".join(f"# {line}" for line in lines)


def _line(picture: "BoardPicture") -> str:
    if picture.unseen or picture.rms_px is None:
        return f"{picture.name}: {picture.unseen or f'{len(picture.corners)} corners of {picture.paper}'}"
    held_out = "" if picture.held_out_px is None else f", {picture.held_out_px:.2f} px by the others alone"
    seen = f"{len(picture.corners)} corners of {picture.paper}, tilted by {picture.tilt_deg:.0f} degrees"
    return f"{picture.name}: {picture.rms_px:.2f} px{held_out}; {seen}"
