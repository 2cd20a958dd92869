"""``/api/v1/fairness``: whether both teams of a match were served alike, as JSON, HTML and picture.

The report takes milliseconds, its picture tens of them: what everybody asks for is made at most once per period.
"""

import asyncio
from collections.abc import Callable
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, HTTPException, Query, Response

from app.web.blackboard import Blackboard
from app.web.cached import Cached
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
EVERY_S = 1.0
FORMS: dict[str, Callable[[FairnessReport], bytes]] = {
    "application/json": lambda report: report.model_dump_json().encode(),
    "text/html": lambda report: html_of(report).encode(),
    "image/png": lambda report: encode_png(draw_fairness(report)),
}
"""What makes the answer of each media type."""
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

    def body_of(form: str, record: str) -> bytes:
        return FORMS[form](report_of(record))

    newest = {form: Cached(partial(body_of, form, ""), EVERY_S) for form in FORMS}

    async def answer(form: str, record: str, headers: dict[str, str] | None = None) -> Response:
        body = await (asyncio.to_thread(body_of, form, record) if record else newest[form].get())
        return Response(body, media_type=form, headers=headers)

    @router.get("/fairness", responses=MISSING, response_model=FairnessReport)
    async def fairness(record: Annotated[str, NAME] = "") -> Response:
        """The impartiality report: places in the order of sending, lags and drops of each team and robot, and the
        verdict. It is three seconds old at most."""
        return await answer("application/json", record)

    @router.get("/fairness.html", response_class=Response, responses=MISSING | _content("text/html"))
    async def page(record: Annotated[str, NAME] = "") -> Response:
        """The report as one file to read and print."""
        return await answer("text/html", record, {"Content-Security-Policy": OWN_STYLE})

    @router.get("/fairness.png", response_class=Response, responses=MISSING | _content("image/png"))
    async def picture(record: Annotated[str, NAME] = "") -> Response:
        """Both teams' places and lags as a picture."""
        return await answer("image/png", record)

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
