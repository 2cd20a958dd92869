"""``pslv patterns``: list markers, check how well they can be distinguished, and print them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.options import ConfigFile
from vision_core.errors import SettingsError

if TYPE_CHECKING:
    from vision_core.patterns.distinctness import PatternReport, Rival
    from vision_core.patterns.pattern import Pattern

app = typer.Typer(no_args_is_help=True, help="Markers that robots wear: list, check and print them.")

Names = Annotated[list[str] | None, typer.Argument(help="Names of config/patterns, or .toml files.")]
PaletteVenue = Annotated[str | None, typer.Option(help="Check the colors against this venue's classes.")]


@app.command("list")
def list_patterns() -> None:
    """List the patterns that come with PSLV."""
    from vision_core.patterns.loader import load_pattern

    for name in _shipped():
        pattern = load_pattern(name)
        ids = [int(key) for key in pattern.code.ids]
        shape = f"{pattern.robot.outline} {2e3 * pattern.robot.radius_m:g} mm, {1e3 * pattern.robot.height_m:g} mm high"
        typer.echo(f"{name:20} {len(ids):2} ids ({min(ids)}..{max(ids)})  {shape}")


@app.command("check")
def check(names: Names = None, venue: PaletteVenue = None, config: ConfigFile = None) -> None:
    """Print how well ids and headings can be distinguished; exit status 2 for a pattern that is refused.

    Several names are a set that is seen on one field. Without names: the venue's patterns, or every shipped one.
    """
    from vision_core.patterns.distinctness import nearest_rival, report_on
    from vision_core.patterns.geometry import SAME_MM
    from vision_core.patterns.loader import load_pattern

    chosen = list(dict.fromkeys(names or _of_venue(venue, config) or _shipped()))
    patterns = [load_pattern(name) for name in chosen]
    reports = [report_on(pattern) for pattern in patterns]
    for report in reports:
        _print(report)
    for i, one in enumerate(patterns if names else []):
        for other in patterns[:i]:
            if (rival := nearest_rival(other, one)) is not None:
                typer.echo(f"{other.name} and {one.name}: {_rival(rival)}")
                if rival.off_mm < SAME_MM:
                    raise SettingsError(
                        "patterns seen together", found=_rival(rival), accepted="robots that look different"
                    )
    if venue is not None or config is not None:
        _check_colors({color: None for report in reports for color in report.colors}, venue, config)
        _check_camera(chosen, venue, config)


@app.command("print")
def print_sheets(
    names: Annotated[list[str], typer.Argument(help="Names of config/patterns, or .toml files.")],
    out: Annotated[Path, typer.Option(help="The PDF file to write.")] = Path("markers.pdf"),
    team: Annotated[str | None, typer.Option(help="blue or yellow; without it, both.")] = None,
    ids: Annotated[str | None, typer.Option(help="Which ids: 1,2,5; without it, all.")] = None,
) -> None:
    """Write sheets of markers as a PDF, true to scale on A4."""
    from vision_core.patterns.loader import load_pattern
    from vision_core.patterns.sheets import write_sheets
    from vision_core.types.objects import Team

    if team is not None and team not in list(Team):
        raise SettingsError("--team", found=team, accepted=", ".join(Team))
    teams = list(Team) if team is None else [Team(team)]
    chosen = [load_pattern(name) for name in names]
    markers = [(one, side, number) for one in chosen for side in teams for number in _ids(one, ids)]
    pages = write_sheets(markers, out)
    typer.echo(f"{out}: {len(markers)} markers on {pages} pages of A4; print at 100 % and measure the ruler")


def _shipped() -> list[str]:
    from vision_core.venues.loader import config_folder

    return sorted(path.stem for path in (config_folder() / "patterns").glob("*.toml"))


def _of_venue(venue: str | None, config: Path | None) -> list[str]:
    from vision_core.models.from_settings import robots_of
    from vision_core.types.objects import Team
    from vision_core.venues.loader import load_settings

    if venue is None and config is None:
        return []
    robots = load_settings(venue, config).robots
    return [name for team in Team for name in robots_of(robots, team).patterns]


def _ids(pattern: "Pattern", wanted: str | None) -> list[int]:
    known = list(pattern.code_by_id)
    if wanted is None:
        return known
    asked = [part.strip() for part in wanted.split(",")]
    if foreign := [part for part in asked if not part.isdecimal() or int(part) not in known]:
        accepted = f"ids of {pattern.name}: {', '.join(map(str, known))}"
        raise SettingsError("--ids", found=", ".join(foreign), accepted=accepted)
    return [int(part) for part in asked]


def _print(report: "PatternReport") -> None:
    ways = "one way" if report.turns == 1 else f"{report.turns} ways, distinguished by colors"
    least = report.fewest_differences
    differ = (
        "one id" if least is None else f"any two ids differ in {least} {'patch' if least == 1 else 'patches'} or more"
    )
    typer.echo(f"{report.name}: {report.ids} ids, in order")
    typer.echo(f"  ids       {differ}; the patches lie on themselves in {ways}")
    typer.echo(f"  heading   {'distinguished by colors alone' if report.rival is None else _rival(report.rival)}")
    typer.echo(
        f"  patches   smallest {report.smallest_mm:.1f} mm wide: under 5 px when a pixel shows more than "
        f"{report.coarsest_mm_per_px:.1f} mm"
    )
    typer.echo(f"  colors    {', '.join(report.colors)}")


def _rival(rival: "Rival") -> str:
    turned = f"turned by {rival.turn_deg:.0f} deg" if rival.turn_deg else "as it stands"
    return f"{rival.one} {turned} is nearest to {rival.other}: a patch is {rival.off_mm:.1f} mm off"


def _check_colors(colors: dict[str, None], venue: str | None, config: Path | None) -> None:
    from vision_core.evaluation.pattern_colors import report_on_colors
    from vision_core.venues.loader import load_settings

    settings = load_settings(venue, config)
    report = report_on_colors(list(colors), settings)
    for first, other, count in report.disputed:
        typer.echo(
            f"colors: {first} and {other} both claim {count} colors of the table; {first}, listed first, has them"
        )
    if report.missing:
        raise SettingsError(
            f"venue {venue or config}: color classes",
            found=f"no class {', '.join(report.missing)}",
            accepted=f"classes for {', '.join(colors)}; there are {', '.join(settings.colors.classes)}",
        )
    typer.echo(f"colors: {len(colors)} classes needed, all there, {len(report.disputed)} pairs disputed")


def _check_camera(chosen: list[str], venue: str | None, config: Path | None) -> None:
    """Warn of what the venue's camera and tolerances make of patterns."""
    import msgspec

    from vision_core.color.lookup_table import compile_color_table
    from vision_core.models.camera_setup import CameraSetup
    from vision_core.objects.robots.pattern_warnings import pattern_warnings
    from vision_core.patterns.loader import load_pattern
    from vision_core.settings.schema import TeamRobotSettings
    from vision_core.venues.loader import load_settings

    settings = load_settings(venue, config)
    camera, table = CameraSetup.from_settings(settings).model, compile_color_table(settings.colors)
    for name in chosen:
        shape = load_pattern(name).robot
        team = TeamRobotSettings(pattern=name, outline=shape.outline, radius_m=shape.radius_m, height_m=shape.height_m)
        worn = msgspec.structs.replace(settings.robots, blue=team, yellow=team)
        for warning in pattern_warnings(msgspec.structs.replace(settings, robots=worn), camera, table):
            typer.echo(f"warning: {warning.key}: {warning.found}; accepted: {warning.accepted}")
