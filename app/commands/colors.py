"""``pslv colors``: measure colors in a picture, ask which class a color is of, and measure the venue's light.

All colors are those that perception judges: of the picture as the venue's light would show it.
"""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from app.commands.options import ConfigFile, Venue
from vision_core.errors import SettingsError

if TYPE_CHECKING:
    from vision_core.geometry import Bytes, Floats
    from vision_core.models.camera_setup import CameraSetup
    from vision_core.settings.schema import Settings
    from vision_core.venues.loader import Layer

colors_app = typer.Typer(no_args_is_help=True, help="Measure colors and light in pictures.")

Picture = Annotated[Path, typer.Argument(help="A picture of the venue.")]
Places = Annotated[list[str], typer.Option("--at", help="Pixels: X,Y or X,Y,X,Y,...; may be repeated.")]
Radius = Annotated[
    int, typer.Option(min=0, max=50, help="A color is the median of the square of pixels up to this far away [px].")
]


@colors_app.command("sample")
def sample(
    picture: Picture,
    name: Annotated[str, typer.Option("--class", help="The class; none: what must not be found.")],
    at: Places,
    radius: Radius = 2,
    venue: Venue = None,
    config: ConfigFile = None,
    save: Annotated[
        bool, typer.Option("--save", help="Write the samples into the file of --config or --venue.")
    ] = False,
) -> None:
    """Measure colors, and print the lines of a venue's file that add them to a class."""
    from vision_core.color.explain import in_words
    from vision_core.color.samples import hex_from_bgr
    from vision_core.venues.loader import Layer, layers_of, settings_from_layers
    from vision_core.venues.palette_edit import sample_table, save_samples

    layers = layers_of(venue, config)
    # the light of the defaults' colors is not that of the samples to come
    to_come = Layer("samples", {"colors": {"samples": {}}})
    settings = settings_from_layers([layers[0], to_come, *layers[1:]], complete_palette=False)
    target = _layer_to_edit(venue, config, layers)
    _check_not_by_ranges(name, target)
    if save and target is None:
        raise SettingsError("--save", found="no file of yours", accepted="--venue FILE.toml or --config FILE.toml")
    pixels = _lit_picture(picture, settings)
    measured = []
    for place in places_of(at):
        bgr = color_at(pixels, place, radius, picture)
        measured.append(hex_from_bgr(bgr.tolist()))
        typer.echo(f"# {place[0]},{place[1]}: {in_words(bgr)}")
    samples = {**settings.colors.samples}
    samples[name] = tuple(dict.fromkeys((*samples.get(name, ()), *measured)))
    typer.echo(sample_table(samples))
    if save and target is not None:
        save_samples(Path(target.name), target.text, samples, name)
    typer.echo(f"# {_where_they_go(target, saved=save)}", err=True)
    if missing := _missing_classes(settings, name):
        typer.echo(f"# classes without a color yet: {', '.join(missing)}; sample them in the same way", err=True)


@colors_app.command("find")
def find(
    pictures: Annotated[list[Path], typer.Argument(help="Pictures of the venue with robots, in about the same light.")],
    venue: Venue = None,
    config: ConfigFile = None,
    save: Annotated[
        bool, typer.Option("--save", help="Write the colors into the file of --config or --venue.")
    ] = False,
) -> None:
    """Find all colors by themselves: camera, field and patterns must be right; exit status 2 when they are doubtful."""
    from app.commands.progress import Progress
    from vision_core.models.camera_setup import CameraSetup
    from vision_core.objects.robots.scene import counted
    from vision_core.palette.find import find_colors
    from vision_core.palette.result import paint_in_words
    from vision_core.venues.loader import layers_of, settings_from_layers
    from vision_core.venues.palette_edit import color_tables, save_colors

    layers = layers_of(venue, config)
    settings = settings_from_layers(layers, complete_palette=False)
    target = _layer_to_edit(venue, config, layers)
    if save and target is None:
        raise SettingsError("--save", found="no file of yours", accepted="--venue FILE.toml or --config FILE.toml")
    camera = CameraSetup.from_settings(settings)
    shown = [_sized_picture(picture, camera) for picture in pictures]
    progress = Progress("finding colors")
    try:
        found = find_colors(shown, settings, lambda share, what: progress.show(f"{share:.0%} {what}"))
    finally:
        progress.show("")
    for picture, read in zip(pictures, found.pictures, strict=True):
        robots, balls = counted(read.robots, "robot"), counted(read.balls, "ball")
        typer.echo(f"# {picture}: {robots}, {read.with_id} with id, {read.clear} clear; {balls}")
    for paint in found.paints:
        typer.echo(f"# {paint.name}: {paint.color}, {paint_in_words(paint.patches)}")
    for reason in found.reasons:
        typer.echo(f"# {reason}")
    typer.echo(color_tables(found.colors))
    if not found.accepted:
        typer.echo(f"# these colors are doubtful{': nothing is saved' if save else ''}", err=True)
        raise typer.Exit(2)
    if save and target is not None:
        save_colors(layers, target, found.colors)
        typer.echo(f"# saved in {target.name}", err=True)


def _layer_to_edit(venue: str | None, config: Path | None, layers: "list[Layer]") -> "Layer | None":
    """The user's own file that samples belong into: --config, or a --venue that is a path; None: a shipped venue."""
    path = str(config) if config is not None else venue
    if path is None or not path.endswith(".toml"):
        return None
    return next(layer for layer in reversed(layers) if layer.name == str(Path(path)))


def _check_not_by_ranges(name: str, target: "Layer | None") -> None:
    """A file defines a class by ranges or by samples; those of the files below it are replaced."""
    from vision_core.venues.loader import place_of

    if target is None or name not in target.table.get("colors", {}).get("classes", {}):
        return
    where = place_of(f"colors.classes.{name}", [target])
    accepted = f"a class that [colors.classes] of this file does not define: delete {name} there, or widen its ranges"
    raise SettingsError(f"--class {name}", found=f"a class by ranges ({where})", accepted=accepted)


def _where_they_go(target: "Layer | None", *, saved: bool) -> str:
    from vision_core.venues.toml_lines import line_of

    if target is None:
        return "append these lines to your venue's file; with --venue FILE.toml --save this command does it"
    if saved:
        return f"saved in {target.name}"
    if "samples" in target.table.get("colors", {}):
        line = line_of(target.text, ["colors", "samples"])
        return f"replace [colors.samples] in line {line} of {target.name} by these lines; --save does it"
    return f"append these lines to {target.name}; --save does it"


def _missing_classes(settings: "Settings", just_sampled: str) -> list[str]:
    """Color classes that the ball and the robots' patterns need and the settings do not define."""
    from vision_core.patterns.worn import colors_of, patterns_by_team
    from vision_core.venues.rules import class_names

    needed = colors_of(patterns_by_team(settings.robots), settings.ball.color, *settings.ball.surrounding)
    return [color for color in needed if color not in (just_sampled, *class_names(settings))]


@colors_app.command("show")
def show(picture: Picture, at: Places, radius: Radius = 0, venue: Venue = None, config: ConfigFile = None) -> None:
    """Say which class a color is of, and why not of another."""
    from vision_core.color.explain import in_words, verdicts
    from vision_core.color.lookup_table import compile_color_table

    settings = _settings(venue, config)
    table = compile_color_table(settings.colors)
    pixels = _lit_picture(picture, settings)
    for place in places_of(at):
        bgr = color_at(pixels, place, radius, picture)
        found = table.names[int(table.classes_of(bgr.round().astype(np.uint8)))]
        typer.echo(f"{place[0]},{place[1]}: {found or 'no class'} | {in_words(bgr)}")
        for verdict in sorted(verdicts(bgr, settings.colors), key=lambda verdict: verdict.miss):
            typer.echo(f"  {verdict.name}: {'claims it' if verdict.claims else f'no: {verdict.why}'}")


@colors_app.command("light")
def light(
    pictures: Annotated[list[Path], typer.Argument(help="Pictures of the venue.")],
    venue: Venue = None,
    config: ConfigFile = None,
) -> None:
    """Measure the light: what colors.light.reference_bgr should be, and the gains that pictures would get."""
    from vision_core.color.light import field_samples, light_of, reference_of
    from vision_core.models.camera_setup import CameraSetup

    settings = _settings(venue, config)
    camera, wanted = CameraSetup.from_settings(settings), settings.colors.light
    samples = field_samples(camera.model, settings.field, camera.size_px, wanted.margin_m)
    for picture in pictures:
        pixels = _sized_picture(picture, camera)
        found, _ = reference_of(pixels, samples, wanted.band)
        if not all(map(math.isfinite, found)):
            accepted = "a camera and colors.light.margin_m for which some of the field lies in the picture"
            raise SettingsError("colors.light", found="no sample of the field in the picture", accepted=accepted)
        over = ", ".join(f"{level - dark:.1f}" for level, dark in zip(found, wanted.black_bgr, strict=True))
        judged = light_of(pixels, samples, wanted)
        gains = judged.reason or f"gains {' '.join(f'{gain:.2f}' for gain in judged.gain_bgr)}"
        typer.echo(f"reference_bgr = [{over}]   # {picture}: {gains}")


def places_of(texts: list[str]) -> list[tuple[int, int]]:
    """Pixels of "X,Y" and "X,Y,X,Y,...". Raises SettingsError."""
    places = []
    for text in texts:
        try:
            numbers = [int(part) for part in text.split(",")]
        except ValueError:
            numbers = []
        if not numbers or len(numbers) % 2:
            raise SettingsError(f"--at {text}", found="no pairs of whole numbers", accepted="X,Y or X,Y,X,Y,...")
        places += list(zip(numbers[::2], numbers[1::2], strict=True))
    return places


def color_at(pixels: "Bytes", place: tuple[int, int], radius: int, picture: Path) -> "Floats":
    """Median color of the square round a pixel, shape (3,), without what lies outside of the picture.

    Raises SettingsError for a pixel outside of the picture.
    """
    x, y = place
    height, width, _ = pixels.shape
    if not (0 <= x < width and 0 <= y < height):
        accepted = f"0..{width - 1},0..{height - 1}, as {picture} has {width}x{height} px"
        raise SettingsError(f"--at {x},{y}", found="a point outside of the picture", accepted=accepted)
    square = pixels[max(y - radius, 0) : y + radius + 1, max(x - radius, 0) : x + radius + 1]
    median: Floats = np.median(square.reshape(-1, 3), axis=0)
    return median


def _settings(venue: str | None, config: Path | None) -> "Settings":
    """Settings whose palette may still lack classes."""
    from vision_core.venues.loader import layers_of, settings_from_layers

    return settings_from_layers(layers_of(venue, config), complete_palette=False)


def _sized_picture(picture: Path, camera: "CameraSetup") -> "Bytes":
    from vision_core.native.opencv import read_picture

    return read_picture(picture, camera.size_px)


def _lit_picture(picture: Path, settings: "Settings") -> "Bytes":
    """The picture as perception sees it; why its light could not be judged is printed to stderr."""
    from vision_core.clock import Instant
    from vision_core.color.light import Lighting
    from vision_core.models.camera_setup import CameraSetup

    camera = CameraSetup.from_settings(settings)
    lighting = Lighting(settings, camera)
    pixels = lighting.lit(_sized_picture(picture, camera), Instant(0))
    if lighting.light.reason:
        typer.echo(lighting.light.reason, err=True)
    return pixels
