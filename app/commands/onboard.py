"""``pslv onboard``: what a robot's own camera would show."""

from pathlib import Path
from typing import Annotated

import typer

from app.commands.options import ConfigFile, Venue, robot_of
from vision_core.errors import SettingsError

onboard_app = typer.Typer(no_args_is_help=True, help="Pictures of a robot's own camera under a hyperboloidal mirror.")


@onboard_app.callback()
def onboard() -> None:
    """Keep ``render`` a command of its own."""


@onboard_app.command("render")
def render(
    output: Annotated[Path, typer.Option("-o", "--output", help="The picture: a file ending in .png or .jpg.")],
    seed: Annotated[int | None, typer.Option(min=0, help="Of the simulated match; none: the venue's.")] = None,
    robot: Annotated[str, typer.Option(help="Whose camera: team and number.")] = "blue:1",
    time: Annotated[float, typer.Option(min=0.0, max=3600.0, help="Instant of the match [s].")] = 0.0,
    size: Annotated[str, typer.Option(help="Width and height of the picture [px].")] = "320x240",
    mirror: Annotated[
        tuple[float, float, float] | None, typer.Option(help="A, B, C of equation 1; none: the venue's.")
    ] = None,
    venue: Venue = None,
    config: ConfigFile = None,
) -> None:
    """Render the on-board picture of a robot of the simulated match, ray by ray."""
    from vision_core.capture.synthetic.world import World
    from vision_core.models.mirror import Mirror
    from vision_core.native.opencv import write_picture
    from vision_core.onboard.camera import OnboardCamera
    from vision_core.venues.loader import load_settings

    settings = load_settings(venue, config, options={"synthetic.seed": seed})
    camera = OnboardCamera(
        settings, robot_of(robot), size_px=_size_of(size), mirror=None if mirror is None else Mirror(*mirror)
    )
    world = World(settings)
    world.advance(time)
    snapshot = world.snapshot()
    write_picture(output, camera.picture(camera.scene(snapshot)))
    x, y, heading = snapshot.robots[camera.row, :3].tolist()
    shape = camera.shape
    typer.echo(
        f"{output}: {robot} at ({x:.2f}, {y:.2f}) m, heading {heading:.2f} rad; viewpoint {shape.h_m * 1e3:.0f} mm "
        f"high, focal length {shape.f_px:.0f} px, {camera.scale:.2f} px of the picture per px of equation 1"
    )


def _size_of(text: str) -> tuple[int, int]:
    """Width and height from 640x480."""
    width, _, height = text.partition("x")
    if not width.isdecimal() or not height.isdecimal():
        raise SettingsError("--size", found=text, accepted="width and height in pixels: 640x480")
    return int(width), int(height)
