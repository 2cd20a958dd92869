"""``/api/v1/fairness``: whether both teams of a match were served alike, as JSON, HTML and picture."""

from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, HTTPException, Query, Response

from app.web.blackboard import Blackboard
from app.web.configuration.configuration import Configuration
from app.web.fairness.kept import KeptReport, KeptReports
from app.web.fairness.page import html_of
from app.web.fairness.picture import draw_fairness
from app.web.problems import PROBLEM, REFUSED
from app.web.reports.fairness import FairnessReport, fairness_report
from vision_core.native.opencv import encode_png

NAME = Query(max_length=100, description="A report that was kept; without it, the record that goes on.")
MISSING: dict[int | str, dict[str, Any]] = {
    404: PROBLEM | {"description": "No report of this name was kept"},
    503: PROBLEM | {"description": "Nothing is recorded yet"},
}
OWN_STYLE = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"
"""The file has its style and its picture within it, and nothing else."""


def fairness_routes(blackboard: Blackboard, configuration: Configuration, kept: KeptReports) -> APIRouter:
    """Impartiality reports."""
    router = APIRouter(prefix="/api/v1", tags=["match"])

    def report_of(record: str) -> FairnessReport:
        running = blackboard.fairness()
        if record:
            report = kept.read(record)
            if running is None or report.record.began_s != float(running["began_s"]):
                return report
        if running is None:
            raise HTTPException(HTTPStatus.SERVICE_UNAVAILABLE, "nothing is recorded yet")
        return fairness_report(running)  # also in place of what was kept of it: the seed is told at its end

    @router.get("/fairness", responses=MISSING)
    def fairness(record: Annotated[str, NAME] = "") -> FairnessReport:
        """The impartiality report: places in the order of sending, lags and drops of each team and robot, and the
        verdict. It is two seconds old at most."""
        return report_of(record)

    @router.get("/fairness.html", response_class=Response, responses=MISSING | _content("text/html"))
    def page(record: Annotated[str, NAME] = "") -> Response:
        """The report as one file to read and print."""
        headers = {"Content-Security-Policy": OWN_STYLE}
        return Response(html_of(report_of(record)), media_type="text/html", headers=headers)

    @router.get("/fairness.png", response_class=Response, responses=MISSING | _content("image/png"))
    def picture(record: Annotated[str, NAME] = "") -> Response:
        """Both teams' places and lags as a picture."""
        return Response(encode_png(draw_fairness(report_of(record))), media_type="image/png")

    @router.get("/fairness/kept")
    def kept_reports() -> list[KeptReport]:
        """The reports of matches that were kept, the newest first."""
        return kept.names()

    @router.post("/fairness/new", responses=REFUSED, status_code=HTTPStatus.ACCEPTED)
    def begin() -> None:
        """Ends the record that goes on, and begins a new one with the next frame."""
        configuration.begin_fairness()

    return router


def _content(media_type: str) -> dict[int | str, dict[str, Any]]:
    return {200: {"content": {media_type: {}}, "description": "The report"}}
