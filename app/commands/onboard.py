"""``pslv onboard``: what a robot's own camera would show."""

from pathlib import Path
from typing import Annotated

import typer

from app.commands.onboard_edges import edges_in
from app.commands.options import ConfigFile, Venue, robot_of
from vision_core.errors import SettingsError

onboard_app = typer.Typer(no_args_is_help=True, help="Pictures of a robot's own camera under a hyperboloidal mirror.")


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


@onboard_app.command("edges")
def edges(
    files: Annotated[list[Path], typer.Argument(help="Pictures, folders of pictures, or videos.")],
    mirror: Annotated[
        tuple[float, float, float] | None, typer.Option(help="A, B, C of equation 1; none: the venue's.")
    ] = None,
    center: Annotated[
        tuple[float, float] | None, typer.Option(help="Of the mirror in the picture [px]; none: found by its rim.")
    ] = None,
    rim: Annotated[float | None, typer.Option(help="Radius of the mirror's rim [px]; none: found.")] = None,
    scale: Annotated[
        float | None, typer.Option(help="Pixels of the picture per pixel of equation 1; none: as `render` has it.")
    ] = None,
    nearest: Annotated[
        float | None, typer.Option(help="Distance of the nearest floor that is seen [mm]; none: the paper's 110.")
    ] = None,
    turn: Annotated[float, typer.Option(help="Where the heading is, anticlockwise from the upper edge [deg].")] = 0.0,
    mirrored: Annotated[bool, typer.Option("--mirrored", help="Left and right are exchanged.")] = False,
    palette: Annotated[
        str, typer.Option(help="Reference colors: rendered, drawn, or a TOML or JSON file (docs/onboard.md).")
    ] = "rendered",
    draw: Annotated[
        Path | None, typer.Option(help="Folder to write the pictures to, with what was recognized.", file_okay=False)
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="One line of JSON per picture.")] = False,
    venue: Venue = None,
    config: ConfigFile = None,
) -> None:
    """Find the nearest edges and the ball in on-board pictures, as a team's own program would."""
    from vision_core.client.recognition import Placement, load_palette
    from vision_core.client.recognition.placement import NEAREST_MM
    from vision_core.models.from_settings import mirror_of
    from vision_core.models.mirror import MM_PER_M, Mirror
    from vision_core.types.objects import Team
    from vision_core.venues.loader import load_settings

    settings = load_settings(venue, config)
    placement = Placement(
        center_px=center,
        rim_px=rim,
        scale=scale,
        nearest_mm=NEAREST_MM if nearest is None else nearest,
        ball_radius_mm=MM_PER_M * settings.ball.radius_m,
        turn_deg=turn,
        mirrored=mirrored,
    )
    shape = Mirror(*mirror) if mirror else mirror_of(settings.mirror, Team.BLUE)
    for line in edges_in(files, shape, placement, load_palette(palette), draw=draw, as_json=as_json):
        typer.echo(line)


def _size_of(text: str) -> tuple[int, int]:
    """Width and height from 640x480."""
    width, _, height = text.partition("x")
    if not width.isdecimal() or not height.isdecimal():
        raise SettingsError("--size", found=text, accepted="width and height in pixels: 640x480")
    return int(width), int(height)
