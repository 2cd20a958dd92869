"""``pslv config``: show settings as the service would use them, and validate them."""

from pathlib import Path
from typing import Annotated

import typer

from app.commands.options import ConfigFile, Venue

config_app = typer.Typer(no_args_is_help=True, help="Look at settings.")


@config_app.command("show")
def show(venue: Venue = None, config: ConfigFile = None) -> None:
    """Print every setting as the service would use it, as JSON."""
    import msgspec

    from vision_core.venues.loader import load_settings

    typer.echo(msgspec.json.format(msgspec.json.encode(load_settings(venue, config)), indent=2).decode())


@config_app.command("validate")
def validate(
    venue: Venue = None,
    config: ConfigFile = None,
    picture: Annotated[
        Path | None, typer.Option(help="A picture by this camera: do its painted lines and robots fit the calibration?")
    ] = None,
) -> None:
    """Say whether settings are in order; exit status 2 when they are not, or the picture contradicts them."""
    from vision_core.evaluation.stills import calibration_reasons_in
    from vision_core.models.camera_setup import CameraSetup
    from vision_core.pipeline.venue_warnings import venue_warnings
    from vision_core.startup.preflight import check_tasks
    from vision_core.tasks.table import check_table
    from vision_core.venues.camera_rules import fit_in_words
    from vision_core.venues.loader import layers_of, place_of, settings_from_layers

    layers = layers_of(venue, config)
    settings = settings_from_layers(layers)
    check_table(settings, lambda key: place_of(key, layers))
    camera = CameraSetup.from_settings(settings)
    check_tasks(settings, camera)
    size = "x".join(map(str, camera.size_px))
    typer.echo(f"in order: field {settings.field.name}, camera {size}{fit_in_words(settings)}")
    for warning in venue_warnings(settings, lambda key: place_of(key, layers)):
        typer.echo(f"warning: {warning}")
    wrong = calibration_reasons_in(picture, settings) if picture is not None else ()
    for reason in wrong:
        typer.echo(f"{picture}: {reason}")
    if wrong:
        raise typer.Exit(2)
