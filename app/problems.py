"""Errors of the API as problem details (RFC 9457): ``application/problem+json``."""

from http import HTTPStatus

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException

from app.reports import Report

MEDIA_TYPE = "application/problem+json"


class Problem(Report):
    """What went wrong with a request."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    instance: str
    """Path of the request."""


def problem_response(request: Request, status: int, detail: str) -> JSONResponse:
    """A problem as the answer to a request."""
    title = HTTPStatus(status).phrase
    problem = Problem(title=title, status=status, detail=detail, instance=request.url.path)
    return JSONResponse(problem.model_dump(), status, media_type=MEDIA_TYPE)


def install_problems(app: FastAPI) -> None:
    """Have every error answered as a problem."""

    async def refused(request: Request, error: Exception) -> JSONResponse:
        assert isinstance(error, HTTPException)
        return problem_response(request, error.status_code, error.detail)

    async def invalid(request: Request, error: Exception) -> JSONResponse:
        assert isinstance(error, RequestValidationError)
        places = [f"{'.'.join(str(part) for part in item['loc'])}: {item['msg']}" for item in error.errors()]
        return problem_response(request, HTTPStatus.UNPROCESSABLE_ENTITY, "; ".join(places))

    async def failed(request: Request, _error: Exception) -> JSONResponse:
        return problem_response(request, HTTPStatus.INTERNAL_SERVER_ERROR, "a bug; the log of the service tells more")

    app.add_exception_handler(HTTPException, refused)
    app.add_exception_handler(RequestValidationError, invalid)
    app.add_exception_handler(Exception, failed)
