"""``pslv calibrate camera``: lens and pose of the camera from the painted lines in pictures."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.options import ConfigFile, Venue
from app.commands.progress import Progress
from vision_core.errors import SettingsError, SourceError

if TYPE_CHECKING:
    from vision_core.calibration.result import Calibration, LineResult, PictureResult
    from vision_core.calibration.start import Start
    from vision_core.geometry import Bytes
    from vision_core.settings.schema import Settings
    from vision_core.venues.loader import Layer

calibrate_app = typer.Typer(no_args_is_help=True, help="Set up a venue from pictures.")

CORNERS = "left top, right top, right bottom, left bottom"


@calibrate_app.callback()
def calibrate_group() -> None:
    """Set up a venue from pictures."""


@calibrate_app.command("camera")
def camera(
    pictures: Annotated[list[Path], typer.Argument(help="Pictures of the field by one camera that did not move.")],
    venue: Venue = None,
    config: ConfigFile = None,
    corners: Annotated[
        str | None,
        typer.Option(help=f"Pixels of the outer corners of the field's lines: X,Y of {CORNERS}. Need not be exact."),
    ] = None,
    find: Annotated[
        bool, typer.Option("--find", help="Search the field in the picture, whatever the venue says.")
    ] = False,
    swap_ends: Annotated[bool, typer.Option("--swap-ends", help="The field's left end is the other one.")] = False,
    height: Annotated[
        float | None, typer.Option(min=0.1, max=100.0, help="Height of the camera by tape measure [m].")
    ] = None,
    measures: Annotated[
        bool, typer.Option("--measures", help="The field's measures, except its length, are estimates: solve them too.")
    ] = False,
    draw: Annotated[Path | None, typer.Option(help="Picture file for an overlay: lines and residuals.")] = None,
    save: Annotated[
        bool, typer.Option("--save", help="Write the camera into the file of --config or --venue.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Everything as one line of JSON.")] = False,
) -> None:
    """Calibrate the camera by the field's painted lines, and print the lines of a venue's file.

    A lens that was measured with a board ([camera.lens], `pslv calibrate lens`) holds; the lines then tell the pose.
    It begins with --corners, else with the venue's own camera; without both, or with --find, the field is searched in
    the picture. A result that cannot be trusted is refused with its reasons, and exit status 2.
    """
    from vision_core.calibration.solve import calibrate, from_other_end
    from vision_core.pipeline.calibration_check import checked_by_robots
    from vision_core.venues.camera_edit import camera_tables, lines_of, save_camera
    from vision_core.venues.loader import layers_of, settings_from_layers

    layers = layers_of(venue, config)
    settings = settings_from_layers(layers, complete_palette=False)
    target = own_file(venue, config, layers, is_needed=save)
    shown = read_pictures(pictures)
    start = None if find else _start(corners, settings, layers, shown[0], height)
    progress = Progress("calibrating")
    try:
        result = calibrate(
            shown,
            settings.field,
            start,
            names=[path.name for path in pictures],
            height_m=height,
            held=settings.camera.lens,
            frees_measures=measures,
            marker_height_m=settings.robots.height_m,
            progress=lambda what, share: progress.show(f"{share:.0%} {what}"),
        )
    finally:
        progress.show("")
    if swap_ends:
        result = from_other_end(result)
    result = checked_by_robots(result, shown[0], settings)
    if draw is not None:
        _draw(draw, shown[0], result)
    typer.echo(_json(result) if as_json else _report(result, settings))
    if not result.accepted:
        raise typer.Exit(2)
    if not as_json:
        typer.echo(lines_of(camera_tables(result.camera, result.size_px, result.measures_m)))
    if save and target is not None:
        save_camera(layers, target, result.camera, result.size_px, result.measures_m)
        typer.echo(f"# saved in {target.name}", err=True)


def read_pictures(pictures: Sequence[Path]) -> "list[Bytes]":
    """The pictures of files, shape (height, width, 3) each. Raises SourceError."""
    from vision_core.native.opencv import read_picture

    return [read_picture(path) for path in pictures]


def _start(
    corners: str | None, settings: "Settings", layers: "list[Layer]", pixels: "Bytes", height_m: float | None
) -> "Start | None":
    """What the calibration begins with: named corners, or the venue's own camera; None: nothing."""
    import numpy as np

    from vision_core.calibration.start import start_from_corners, start_from_settings

    height, width, _ = pixels.shape
    if corners is not None:
        points = np.array(_numbers(corners)).reshape(4, 2)
        return start_from_corners(points, settings.field, (width, height), height_m=height_m, held=settings.camera.lens)
    if not _has_own_camera(layers):
        return None
    wanted = settings.camera.width_px, settings.camera.height_px
    if wanted != (width, height):
        accepted = f"{wanted[0]}x{wanted[1]} as the venue's camera has, or --corners, or --find"
        raise SourceError("the picture", found=f"{width}x{height} px", accepted=accepted)
    return start_from_settings(settings.camera, height_m=height_m)


def _has_own_camera(layers: "list[Layer]") -> bool:
    """Does a file other than the shipped defaults describe the camera's lens or points?"""
    from vision_core.settings.layers import LayerKind

    own = [layer.table.get("camera", {}) for layer in layers if layer.kind is not LayerKind.DEFAULT]
    return any("pinhole" in table or "homography" in table for table in own)


def _numbers(text: str) -> list[float]:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 8:
        raise SettingsError(f"--corners {text}", found="not eight numbers", accepted=f"X,Y of {CORNERS}")
    return numbers


def own_file(venue: str | None, config: Path | None, layers: "list[Layer]", *, is_needed: bool) -> "Layer | None":
    """The user's own file: --config, or a --venue that is a path; None: a shipped venue.

    Raises SettingsError when it is needed.
    """
    path = str(config) if config is not None else venue
    if path is not None and path.endswith(".toml"):
        return next(layer for layer in reversed(layers) if layer.name == str(Path(path)))
    if is_needed:
        raise SettingsError("--save", found="no file of yours", accepted="--venue FILE.toml or --config FILE.toml")
    return None


def _draw(path: Path, pixels: "Bytes", result: "Calibration") -> None:
    from vision_core.calibration.draw import draw_calibration
    from vision_core.native.opencv import write_picture

    write_picture(path, draw_calibration(pixels, result))


def _json(result: "Calibration") -> str:
    import msgspec

    return json.dumps(msgspec.to_builtins(result))


def _report(result: "Calibration", settings: "Settings") -> str:
    """The verdict as comments of TOML."""
    lines = [_line(line) for line in result.lines]
    if result.pictures:
        lines += [_picture(picture) for picture in result.pictures]
    markers = f"markers at {settings.robots.height_m:g} m up to {result.marker_error_m * 1e3:.1f} mm"
    lines += [
        f"{result.rms_px:.2f} px rms over {result.samples} sections, {result.coverage:.0%} of the field",
        f"places on the floor are up to {result.floor_error_m * 1e3:.1f} mm off, {markers} (two deviations)",
        f"condition number {result.condition:.2g}",
        *(f"note: {note}" for note in result.notes),
        *(f"refused: {reason}" for reason in result.reasons),
    ]
    return "\n".join(f"# {line}" for line in lines)


def _picture(picture: "PictureResult") -> str:
    if picture.shift_px is None:
        return f"{picture.name}: {picture.sections} sections, too few to compare it with the others"
    return f"{picture.name}: {picture.sections} sections, {picture.apart_px:.2f} px from where the others show them"


def _line(line: "LineResult") -> str:
    if line.rms_px is None:
        beside = "" if line.beside_px is None else f", seen {line.beside_px:.0f} px beside its place"
        return f"{line.name}: not measured, {line.visible:.0%} of it is in the picture{beside}"
    held_out = "" if line.held_out_px is None else f", {line.held_out_px:.2f} px by the others alone"
    return f"{line.name}: {line.rms_px:.2f} px, {line.found:.0%} of it{held_out}"
