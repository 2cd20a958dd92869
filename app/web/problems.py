"""Errors of the API as problem details (RFC 9457): ``application/problem+json``."""

import json
from collections.abc import Callable, Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from starlette.exceptions import HTTPException

from app.web.reports.base import Report
from vision_core.errors import PslvError

MEDIA_TYPE = "application/problem+json"
MAX_FOUND = 200
MAX_ECHO = 80
"""Characters of what a stranger sent that an answer repeats."""


class ProblemDetails(Report):
    """Why a request failed."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    instance: str
    """Path of the request."""
    asked: str | None = None
    """What a request asked for that was understood and refused."""
    found: str | None = None
    """What was found instead."""
    accepted: str | None = None
    """What would be accepted."""
    field: str | None = None
    """The setting or the field of a form that is wrong."""


COMPONENT = ProblemDetails.__name__
PROBLEM: dict[str, Any] = {"content": {MEDIA_TYPE: {"schema": {"$ref": f"#/components/schemas/{COMPONENT}"}}}}
"""A refusal in the OpenAPI document, which has the model once."""
REFUSED: dict[int | str, dict[str, Any]] = {
    401: PROBLEM | {"description": "Nobody is logged in"},
    403: PROBLEM | {"description": "Only the operator may change something, from our own page or a program, as JSON"},
    404: PROBLEM | {"description": "There is nothing of this name"},
    409: PROBLEM | {"description": "It does not fit to the present state, or somebody else was faster"},
    422: PROBLEM | {"description": "A value is not accepted: ``field`` names it, ``accepted`` says what would be"},
}
"""Refusals that every change may be answered with, for the OpenAPI document."""


class RequestRefused(HTTPException):
    """A request that was understood and is refused."""

    def __init__(self, status: HTTPStatus, asked: str, *, found: str, accepted: str, field: str = "") -> None:
        super().__init__(status, str(PslvError(asked, found=found, accepted=accepted)))
        self.parts = {"asked": asked, "found": found, "accepted": accepted} | ({"field": field} if field else {})


def cut(text: str) -> str:
    """A text of a stranger, short enough to be repeated."""
    return text if len(text) <= MAX_ECHO else f"{text[:MAX_ECHO]} ..."


def problem_response(
    request: Request, status: int, detail: str, parts: Mapping[str, str] | None = None
) -> JSONResponse:
    """The answer to a request that failed; parts: what it asked, what was found and what would be accepted."""
    title = HTTPStatus(status).phrase
    problem = ProblemDetails(title=title, status=status, detail=detail, instance=cut(request.url.path), **(parts or {}))
    return JSONResponse(problem.model_dump(exclude_none=True), status, media_type=MEDIA_TYPE)


def install_problems(app: FastAPI, lost: Callable[[Request], Response | None]) -> None:
    """Answer every error with problem details. lost: the answer to a request for nothing; None: problem details."""

    async def refused(request: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        if error.status_code == HTTPStatus.NOT_FOUND and (page := lost(request)) is not None:
            return page
        parts = error.parts if isinstance(error, RequestRefused) else None
        return problem_response(request, error.status_code, error.detail, parts)

    async def invalid(request: Request, error: Exception) -> JSONResponse:
        assert isinstance(error, RequestValidationError)
        parts = _first(error.errors())
        words = PslvError(parts["asked"], found=parts["found"], accepted=parts["accepted"])
        return problem_response(request, HTTPStatus.UNPROCESSABLE_ENTITY, str(words), parts)

    async def failed(request: Request, _error: Exception) -> JSONResponse:
        return problem_response(
            request, HTTPStatus.INTERNAL_SERVER_ERROR, "a bug in the service; its log has the details"
        )

    describe = app.openapi

    def openapi() -> dict[str, Any]:
        document = describe()
        document["components"]["schemas"].setdefault(COMPONENT, ProblemDetails.model_json_schema())
        return document

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's own way to extend the document
    app.add_exception_handler(HTTPException, refused)
    app.add_exception_handler(RequestValidationError, invalid)
    app.add_exception_handler(Exception, failed)


def _first(errors: Sequence[Any]) -> dict[str, str]:
    """The first error of a request: what was asked, found and accepted."""
    error = errors[0]
    if error["type"] == "json_invalid":
        return {"asked": "the request's body", "found": str(error["ctx"]["error"]), "accepted": "JSON"}
    return {
        "field": ".".join(str(part) for part in error["loc"][1:]),
        "asked": ".".join(str(part) for part in error["loc"]),
        "found": json.dumps(error.get("input"), default=str)[:MAX_FOUND],
        "accepted": error["msg"].removeprefix("Input should be "),
    }
