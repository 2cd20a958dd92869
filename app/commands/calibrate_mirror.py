"""``pslv calibrate mirror``: A, B, C of equation 1 from pairs of a radius and a distance."""

import json
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.calibrate import own_file
from app.commands.options import ConfigFile, Venue
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.errors import SettingsError

if TYPE_CHECKING:
    from app.commands.mirror_pictures import PictureOptions
    from vision_core.calibration.mirror.fit import FocalPrior
    from vision_core.calibration.mirror.pairs import Pairs
    from vision_core.calibration.mirror.result import MirrorCalibration
    from vision_core.settings.schema import Settings


def mirror(
    pairs: Annotated[
        Path | None, typer.Argument(help="CSV: radius in px and distance from the robot's center on the floor in mm.")
    ] = None,
    picture: Annotated[
        list[Path] | None, typer.Option(help="On-board picture: heading up, left at the left. Several times.")
    ] = None,
    at: Annotated[
        list[float] | None, typer.Option(help="Distance on the floor of the target in the picture [mm]; one for each.")
    ] = None,
    click: Annotated[
        list[str] | None,
        typer.Option(help="X,Y near the target's edge; one for each picture. None: the strongest edge in --direction."),
    ] = None,
    direction: Annotated[
        float, typer.Option(help="Of the target, anticlockwise from the robot's heading [degrees].")
    ] = 0.0,
    around: Annotated[
        list[Path] | None,
        typer.Option(
            help="What stands around the robot; one for each picture: CSV with direction in degrees and distance in mm,"
            " or the ceiling camera's picture of the same instant."
        ),
    ] = None,
    robot: Annotated[str, typer.Option(help="Whose on-board pictures they are: team and number.")] = "blue:1",
    center: Annotated[
        str | None, typer.Option(help="X,Y of the mirror's center in the pictures; none: their middle.")
    ] = None,
    scale: Annotated[
        float, typer.Option(min=0.01, max=100.0, help="Pixels of the pictures per pixel of equation 1.")
    ] = 1.0,
    venue: Venue = None,
    config: ConfigFile = None,
    focal: Annotated[
        float | None, typer.Option(min=1.0, max=1e5, help="Focal length of the on-board camera [px].")
    ] = None,
    focal_sd: Annotated[
        float | None, typer.Option(min=0.0, help="Its standard deviation [px]; a tenth of it if none is said.")
    ] = None,
    field: Annotated[
        str | None, typer.Option(help="Field preset that the mirror has to resolve, if not that of the venue.")
    ] = None,
    radii: Annotated[
        Rounding,
        typer.Option(help="int: cut to whole numbers as in `see` messages; auto: so if all of them are whole."),
    ] = Rounding.AUTO,
    draw: Annotated[Path | None, typer.Option(help="Picture file: curve, band and pairs.")] = None,
    whose: Annotated[
        str, typer.Option("--for", help="Whose mirror it is: field, a team (blue), or a robot (blue:3).")
    ] = "field",
    save: Annotated[
        bool, typer.Option("--save", help="Write the mirror into the file of --config or --venue.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Everything as one line of JSON.")] = False,
) -> None:
    """Fit the mirror of the robots' on-board cameras, and print a venue's [mirror].

    By pairs from a file, from on-board pictures of a target at known distances (--picture --at), or from what stands
    around the robot while a picture is taken (--picture --around). A result that cannot be trusted is refused with its
    reasons, and exit status 2.
    """
    from app.commands.mirror_pictures import PictureOptions
    from app.commands.options import scope_from
    from vision_core.calibration.mirror.draw import draw_mirror
    from vision_core.calibration.mirror.verdict import calibrate_mirror
    from vision_core.native.opencv import write_picture
    from vision_core.venues.camera_edit import lines_of, mirror_tables, save_mirror
    from vision_core.venues.loader import layers_of, settings_from_layers
    from vision_core.venues.presets import field_of

    team, number = scope_from(whose)
    layers = layers_of(venue, config)
    target = own_file(venue, config, layers, is_needed=save)
    settings = settings_from_layers(layers)
    shown = PictureOptions(picture or [], at or [], click or [], direction, around or [], robot, center, scale)
    preset = field_of(field) if field else settings.field
    result = calibrate_mirror(_pairs(pairs, radii, shown, settings), _prior(focal, focal_sd), preset)
    if draw is not None:
        write_picture(draw, draw_mirror(result))
    typer.echo(_json(result) if as_json else _report(result))
    if not result.accepted or result.mirror is None:
        raise typer.Exit(2)
    if not as_json:
        typer.echo(lines_of(mirror_tables(result.mirror, team, number)))
    if save and target is not None:
        save_mirror(layers, target, result.mirror, team, number)
        typer.echo(f"# saved in {target.name}", err=True)


def _pairs(path: Path | None, radii: Rounding, shown: "PictureOptions", settings: "Settings") -> "Pairs":
    """Of the file and of the pictures."""
    from app.commands.mirror_pictures import pairs_from_pictures
    from vision_core.calibration.mirror.pairs import Pairs, read_pairs

    seen = pairs_from_pictures(shown, settings)
    parts = [part for part in (read_pairs(path, radii) if path else None, seen) if part is not None]
    if not parts:
        raise SettingsError("the mirror", found="no pairs", accepted="a CSV file, or --picture with --at or --around")
    return reduce(Pairs.joined, parts)


def _prior(focal: float | None, deviation: float | None) -> "FocalPrior | None":
    from vision_core.calibration.mirror.fit import focal_prior

    if focal is None and deviation is not None:
        raise SettingsError("--focal-sd", found="no --focal", accepted="--focal PX with it")
    return None if focal is None else focal_prior(focal, deviation)


def _json(result: "MirrorCalibration") -> str:
    import msgspec

    return json.dumps(msgspec.to_builtins(result))


def _report(result: "MirrorCalibration") -> str:
    """The verdict as comments of TOML."""
    lines = [
        *result.words,
        *(f"note: {note}" for note in result.notes),
        *(f"refused: {reason}" for reason in result.reasons),
    ]
    if result.shape is not None:
        shape = result.shape
        lines.insert(0, f"f {shape.focal_px:.0f} px, h {shape.height_mm:.0f} mm, u {shape.bend:.2f}")
    return "\n".join(f"# {line}" for line in lines)
