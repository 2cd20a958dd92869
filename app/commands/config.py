"""``pslv config``: show settings as the service would use them, and validate them."""

from typing import TYPE_CHECKING

import typer

from app.commands.options import ConfigFile, Venue

if TYPE_CHECKING:
    from vision_core.settings.schema import Settings

config_app = typer.Typer(no_args_is_help=True, help="Look at settings.")


@config_app.command("show")
def show(venue: Venue = None, config: ConfigFile = None) -> None:
    """Print every setting as the service would use it, as JSON."""
    import msgspec

    from vision_core.venues.loader import load_settings

    typer.echo(msgspec.json.format(msgspec.json.encode(load_settings(venue, config)), indent=2).decode())


@config_app.command("validate")
def validate(venue: Venue = None, config: ConfigFile = None) -> None:
    """Say whether settings are in order; exit status 2 when they are not."""
    from vision_core.models.camera_setup import CameraSetup
    from vision_core.patterns.match_rules import match_warnings
    from vision_core.startup.preflight import check_tasks
    from vision_core.tasks.table import check_table
    from vision_core.venues.loader import layers_of, place_of, settings_from_layers

    layers = layers_of(venue, config)
    settings = settings_from_layers(layers)
    check_table(settings, lambda key: place_of(key, layers))
    camera = CameraSetup.from_settings(settings)
    check_tasks(settings, camera)
    size = "x".join(map(str, camera.size_px))
    typer.echo(f"in order: field {settings.field.name}, camera {size}{_fit(settings)}")
    for warning in match_warnings(settings, lambda key: place_of(key, layers)):
        typer.echo(f"warning: {warning}")


def _fit(settings: "Settings") -> str:
    """How well a camera from named points fits them, in words; empty for a calibrated lens."""
    from vision_core.venues.camera_rules import fit_residual

    homography = settings.camera.homography
    if settings.camera.model != "homography" or homography is None:
        return ""
    if len(homography.points) == 4:
        return " from four points (which fit exactly: further points would show an error)"
    residual = fit_residual(homography.points)
    rms, worst = f"{residual.rms_px:.1f} px rms", f"{residual.worst_px:.1f} px at {residual.worst!r}"
    return f" from {len(homography.points)} points, residual {rms}, worst {worst}"
