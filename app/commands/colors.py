"""``pslv colors``: measure colors in a picture, ask which class a color is of, and measure the venue's light.

All colors are those that perception judges: of the picture as the venue's light would show it.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from app.commands.options import ConfigFile, Venue
from vision_core.errors import SettingsError, SourceError

if TYPE_CHECKING:
    from vision_core.geometry import Bytes, Floats
    from vision_core.models.camera_setup import CameraSetup
    from vision_core.settings.schema import Settings

colors_app = typer.Typer(no_args_is_help=True, help="Measure colors and light in pictures.")

Picture = Annotated[Path, typer.Argument(help="A picture of the venue.")]
Places = Annotated[list[str], typer.Option("--at", help="Pixels: X,Y or X,Y,X,Y,...; may be repeated.")]
Radius = Annotated[int, typer.Option(min=0, max=50, help="A color is the median of a square that reaches so far [px].")]


@colors_app.command("sample")
def sample(
    picture: Picture,
    name: Annotated[str, typer.Option("--class", help="The class; none: what must not be found.")],
    at: Places,
    radius: Radius = 2,
    venue: Venue = None,
    config: ConfigFile = None,
) -> None:
    """Print the lines of a venue that make a class of measured colors."""
    from vision_core.color.explain import in_words
    from vision_core.color.samples import hex_from_bgr
    from vision_core.venues.loader import load_settings

    settings = load_settings(venue, config)
    if name in settings.colors.classes:
        accepted = "a class that colors.classes does not have: take it out there, or give its boxes wider bounds"
        raise SettingsError(f"--class {name}", found="a class by ranges", accepted=accepted)
    pixels = _lit_picture(picture, settings)
    measured = []
    for place in places_of(at):
        bgr = color_at(pixels, place, radius, picture)
        measured.append(hex_from_bgr(bgr.tolist()))
        typer.echo(f"# {place[0]},{place[1]}: {in_words(bgr)}")
    samples = {**settings.colors.samples}
    samples[name] = tuple(dict.fromkeys((*samples.get(name, ()), *measured)))
    typer.echo("[colors.samples]")
    for known, texts in samples.items():
        quoted = ", ".join(f'"{text}"' for text in texts)
        typer.echo(f"{known} = [{quoted}]")


@colors_app.command("show")
def show(picture: Picture, at: Places, radius: Radius = 0, venue: Venue = None, config: ConfigFile = None) -> None:
    """Say which class a color is of, and why not of another."""
    from vision_core.color.explain import in_words, verdicts
    from vision_core.color.lookup_table import compile_color_table
    from vision_core.venues.loader import load_settings

    settings = load_settings(venue, config)
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
    from vision_core.venues.loader import load_settings

    settings = load_settings(venue, config)
    camera, wanted = CameraSetup.from_settings(settings), settings.colors.light
    samples = field_samples(camera.model, settings.field, camera.size_px, wanted.margin_m)
    for picture in pictures:
        pixels = _sized_picture(picture, camera)
        found, _ = reference_of(pixels, samples, wanted.band)
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
    """Median color round a pixel, shape (3,); what of the square lies outside is left out. Raises SettingsError."""
    x, y = place
    height, width, _ = pixels.shape
    if not (0 <= x < width and 0 <= y < height):
        accepted = f"0..{width - 1},0..{height - 1}, as {picture} has {width}x{height} px"
        raise SettingsError(f"--at {x},{y}", found="a point outside of the picture", accepted=accepted)
    square = pixels[max(y - radius, 0) : y + radius + 1, max(x - radius, 0) : x + radius + 1]
    median: Floats = np.median(square.reshape(-1, 3), axis=0)
    return median


def _sized_picture(picture: Path, camera: "CameraSetup") -> "Bytes":
    from vision_core.native.opencv import read_picture

    pixels = read_picture(picture)
    if pixels.shape != camera.shape:
        accepted = f"{camera.size_px[0]}x{camera.size_px[1]} (camera.width_px, camera.height_px of the venue)"
        raise SourceError(f"picture {picture}", found=f"{pixels.shape[1]}x{pixels.shape[0]} px", accepted=accepted)
    return pixels


def _lit_picture(picture: Path, settings: "Settings") -> "Bytes":
    """The picture as perception sees it. A light that cannot be judged is told on stderr."""
    from vision_core.clock import Instant
    from vision_core.color.light import Lighting
    from vision_core.models.camera_setup import CameraSetup

    camera = CameraSetup.from_settings(settings)
    lighting = Lighting(settings, camera)
    pixels = lighting.lit(_sized_picture(picture, camera), Instant(0))
    if lighting.light.reason:
        typer.echo(lighting.light.reason, err=True)
    return pixels
