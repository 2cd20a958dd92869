"""``pslv fairness``: the impartiality report of the match that a service of this machine serves."""

import urllib.error
import urllib.request
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from app.commands.running import only_service
from vision_core.errors import PslvError, ServiceError, SourceError

if TYPE_CHECKING:
    from app.web.fairness.kept import KeptReports
    from app.web.reports.fairness import FairnessReport, ServedReport
    from vision_core.rtdb.infos import ServiceInfo

NEW = "/api/v1/fairness/new"
TIMEOUT_S = 5.0
STYLES = {"impartial": "green", "not_proven": "yellow", "biased": "red"}
File = Path | None


def fairness(
    service: Annotated[str | None, typer.Option(help="Name of the service when several run: pslv/8000.")] = None,
    record: Annotated[str, typer.Option(help="A report that was kept: its name, as --list shows it.")] = "",
    list_: Annotated[bool, typer.Option("--list", help="List the reports that were kept.")] = False,
    new: Annotated[bool, typer.Option("--new", help="End the record that goes on, and begin a new one.")] = False,
    json: Annotated[File, typer.Option(help="Write the report as JSON.")] = None,
    html: Annotated[File, typer.Option(help="Write the report as one HTML file.")] = None,
    picture: Annotated[File, typer.Option(help="Write places and lags as a PNG picture.")] = None,
) -> None:
    """Show whether both teams are served alike: order of sending, lags, drops and a verdict."""
    from app.web.blackboard import Blackboard
    from app.web.fairness.kept import KeptReports
    from app.web.reports.fairness import fairness_report
    from vision_core.net.control import attach_to

    blackboard = Blackboard(attach_to(service or only_service("pslv fairness")).store)
    kept = KeptReports(Path(blackboard.service.database))
    if new:
        _begin(blackboard.service)
        typer.echo("a new record begins with the next frame")
        return
    if list_:
        typer.echo("\n".join(each.name for each in kept.names()) or f"none was kept yet in {kept.folder}")
        return
    running = blackboard.fairness()
    if record:
        report = _kept(kept, record)
    elif running is not None:
        report = fairness_report(running)
    else:
        raise ServiceError("pslv fairness", found="nothing is recorded yet", accepted="a service that is ready")
    _print(report)
    _write(report, json, html, picture)


def _kept(reports: "KeptReports", name: str) -> "FairnessReport":
    """A report that was kept. Raises PslvError when there is none of this name."""
    from app.web.problems import RequestRefused

    try:
        return reports.read(name)
    except RequestRefused as refused:
        raise PslvError(**{key: refused.parts[key] for key in ("asked", "found", "accepted")}) from None


def _print(report: "FairnessReport") -> None:
    """The report for a terminal."""
    console = Console(highlight=False)
    words = report.verdict.value.replace("_", " ")
    console.print(f"{words}: {report.record.frames} frames", style=STYLES[report.verdict])
    for reason in report.reasons:
        console.print(f"  {reason}", markup=False, soft_wrap=True)
    table = Table("", "sent", "dropped", "place", "lag mean", "p50", escape("p99 [ms]"), "chi-square", "p", box=None)
    for column in table.columns[1:]:
        column.justify = "right"
    places = report.places
    for team in report.teams:
        test = f"{places.chi_square:.1f} / {places.freedom}", f"{places.p:.3g}"
        table.add_row(f"{team.team} {team.name}".strip(), *_cells(team), *test)
    for robot in report.robots:
        test = f"{robot.chi_square:.1f} / {robot.freedom}", f"{robot.p:.3g}"
        table.add_row(f"{robot.team} {robot.number}", *_cells(robot), *test, style="dim")
    console.print(table, soft_wrap=True)


def _cells(served: "ServedReport") -> tuple[str, ...]:
    lags_ms = served.lag_mean_ms, served.lag_p50_ms, served.lag_p99_ms
    lags = ("" if lag_ms is None else f"{lag_ms:.3f}" for lag_ms in lags_ms)
    return str(served.sent), str(served.dropped), f"{served.mean_place:.3f}", *lags


def _write(report: "FairnessReport", json: File, html: File, picture: File) -> None:
    """Write the files that are asked for. Raises SourceError."""
    from app.web.fairness.page import html_of
    from app.web.fairness.picture import draw_fairness
    from vision_core.native.opencv import write_picture

    try:
        if json is not None:
            json.write_text(report.model_dump_json(indent=1), encoding="utf-8")
        if html is not None:
            html.write_text(html_of(report), encoding="utf-8")
    except OSError as error:
        raise SourceError(f"file {error.filename}", found=error.strerror or str(error)) from None
    if picture is not None:
        write_picture(picture, draw_fairness(report))


def _begin(service: "ServiceInfo") -> None:
    """Ask the service for a new record, as the operator. Raises PslvError."""
    from contextlib import closing

    from app.web.auth.people import People
    from app.web.auth.people_file import people_path

    with closing(People(people_path(service))) as people:
        made, secret = people.new_token("pslv fairness --new")
        headers = {"authorization": f"Bearer {secret}", "content-type": "application/json"}
        asked = urllib.request.Request(service.http + NEW, b"{}", headers, method="POST")  # noqa: S310 (our own service)
        try:
            with urllib.request.urlopen(asked, timeout=TIMEOUT_S) as answer:  # noqa: S310
                status = answer.status
        except (OSError, urllib.error.HTTPError) as error:
            raise PslvError("pslv fairness --new", found=str(error), accepted="a page that answers") from None
        finally:
            people.revoke_token(made.id)
    if status != HTTPStatus.ACCEPTED:
        raise PslvError("pslv fairness --new", found=f"status {status}")
