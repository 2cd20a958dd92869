"""``pslv venue``: set up a venue from pictures, as a dialogue or by options; list the venues there are."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.progress import Progress

if TYPE_CHECKING:
    from app.commands.venue_dialogue import Talk
    from vision_core.setup.draft import Draft
    from vision_core.setup.findings import PictureTrial, VenueTrial

venue_app = typer.Typer(no_args_is_help=True, help="Set up and list venues.")
CORNERS = "left top, right top, right bottom, left bottom"


@venue_app.callback()
def venue_group() -> None:
    """Set up and list venues."""


@venue_app.command("list")
def list_venues() -> None:
    """List the venues that come with PSLV and those of this machine, for --venue."""
    from vision_core.venues.loader import own_venues_folder
    from vision_core.venues.presets import shipped

    for name in shipped("venues"):
        typer.echo(f"{name:20} comes with PSLV")
    for path in sorted(own_venues_folder().glob("*.toml")):
        typer.echo(f"{path.stem:20} {path}")


@venue_app.command("new")
def new(
    name: Annotated[str, typer.Argument(help="Name of the venue: small letters, digits, - and _.")],
    pictures: Annotated[
        list[Path] | None, typer.Option("--pictures", help="A picture of the field; again for each further one.")
    ] = None,
    field: Annotated[
        str | None, typer.Option(help="Field preset of config/fields; find: the one whose lines are in the picture.")
    ] = None,
    size: Annotated[
        str | None, typer.Option("--size", help="LENGTH,WIDTH of the field [m], where they are not the preset's.")
    ] = None,
    pattern: Annotated[str | None, typer.Option(help="Marker pattern of config/patterns.")] = None,
    marker_height: Annotated[
        float | None, typer.Option(min=0.0, max=2.0, help="Of the markers over the floor [m].")
    ] = None,
    robot_radius: Annotated[float | None, typer.Option(min=0.006, max=1.0, help="Of the robots [m].")] = None,
    numbers: Annotated[int | None, typer.Option(min=1, max=16, help="Robots per team.")] = None,
    ball: Annotated[str | None, typer.Option(help="Color of the ball.")] = None,
    ball_radius: Annotated[float | None, typer.Option(min=0.003, max=0.5, help="Of the ball [m].")] = None,
    corners: Annotated[
        str | None,
        typer.Option(help=f"Pixels X,Y of {CORNERS} corner of the field in the first picture; find: by its lines."),
    ] = None,
    walls: Annotated[
        bool, typer.Option("--walls", help="The corners are those of walls: no line is looked at.")
    ] = False,
    height: Annotated[
        float | None, typer.Option(min=0.1, max=100.0, help="Height of the camera by tape measure [m].")
    ] = None,
    swap_ends: Annotated[bool, typer.Option("--swap-ends", help="The field's left end is the other one.")] = False,
    measures: Annotated[bool, typer.Option("--measures", help="Solve the field's measures too.")] = False,
    find_colors: Annotated[
        bool, typer.Option("--find-colors", help="Find the colors in the pictures by themselves.")
    ] = False,
    sample: Annotated[
        list[str] | None,
        typer.Option(help="CLASS=X,Y of the first picture, CLASS=N:X,Y of the N-th, or CLASS=#rrggbb; again for more."),
    ] = None,
    source: Annotated[
        str | None, typer.Option(help="camera:0, ...; pictures: those that are given; without it, none.")
    ] = None,
    about: Annotated[str, typer.Option(help="A sentence about the venue.")] = "",
    draw: Annotated[Path | None, typer.Option(help="Folder for overlays of what is seen with the venue.")] = None,
    replace: Annotated[bool, typer.Option("--replace", help="Replace a venue of this name.")] = False,
) -> None:
    """Set up a venue from pictures. On a terminal it asks for what no option says; elsewhere it names the option.

    The page does the same under *New venue*, with pictures to click on.
    """
    from app.commands.venue_dialogue import Answers, Talk, set_up
    from vision_core.setup.venue_file import save_venue

    answers = Answers(
        name=name,
        about=about,
        source=source or "",
        pictures=tuple(pictures or ()),
        field=field,
        size=size,
        pattern=pattern,
        marker_height=marker_height,
        robot_radius=robot_radius,
        numbers=numbers,
        ball=ball,
        ball_radius=ball_radius,
        corners=corners,
        walls=walls,
        height=height,
        swap_ends=swap_ends,
        measures=measures,
        samples=tuple(sample or ()),
        finds_colors=find_colors,
    )
    talk = Talk(interactive=_is_terminal(), progress=Progress("new venue"))
    draft, files = set_up(answers, talk)
    _try(draft, files, talk, draw)
    path = save_venue(draft, files, replaces=replace)
    typer.echo(f"saved in {path}; start with: pslv serve --venue {draft.name}")


def _is_terminal() -> bool:
    return sys.stdin.isatty() and sys.stdout.isatty()


def _try(draft: "Draft", files: tuple[Path, ...], talk: "Talk", draw: Path | None) -> None:
    """Say what is seen in the pictures with the venue."""
    from tempfile import TemporaryDirectory

    from vision_core.setup.trial import try_venue
    from vision_core.setup.venue_file import settings_of

    settings = settings_of(draft, complete=True)
    with TemporaryDirectory() as folder:
        trial = talk.working(lambda tell: try_venue(files, settings, None, draw or Path(folder), tell))
    for picture, seen in zip(draft.pictures, trial.pictures, strict=True):
        typer.echo(f"{picture.name}: {_in_words(seen)}")
        for reason in seen.reasons:
            typer.echo(f"  {reason}")
    typer.echo(_sum(trial))


def _in_words(seen: "PictureTrial") -> str:
    robots = ", ".join(f"{robot.team} {'?' if robot.id is None else robot.id}" for robot in seen.robots) or "none"
    return seen.error or f"robots: {robots}; balls: {seen.balls}"


def _sum(trial: "VenueTrial") -> str:
    robots, read = (sum(each) for each in zip(*((len(p.robots), p.read) for p in trial.pictures), strict=True))
    return f"in all: {robots} robots, {read} with an id, {sum(p.balls for p in trial.pictures)} balls"
