"""The page: one application for all its addresses, its scripts, and the API's documentation.

It is built from web/src (see web/build.py). While it is missing, a short page says what is being done, or what is
missing; the service and its API run all the same.
"""

from functools import cache
from html import escape
from pathlib import Path

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse, HTMLResponse, Response
from starlette.staticfiles import StaticFiles

import app
from app.web.auth.rules import GUARDED, READING

ADDRESSES = (
    "/",
    "/teams",
    "/robots",
    "/robot",
    "/robot/{team}/{number}",
    "/camera",
    "/calibrate",
    "/mirror",
    "/3d",
    "/settings",
    "/timing",
    "/fairness",
    "/logs",
    "/about",
    "/login",
)
"""Addresses of the page; its own router shows what belongs to each."""
MISSING = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="3"><title>PSLV</title></head>
<body><h1>PSLV</h1><p>The page is not there yet: {}</p>
<p>Robots are served and the <a href="/api/v1/status">API</a> answers all the same. This page looks again by itself.</p>
</body></html>"""


@cache
def web_folder() -> Path:
    """The folder of the built page: inside the installed package, or beside it in a checkout."""
    assert app.__file__ is not None
    package = Path(app.__file__).parent
    inside = package / "web" / "static"
    return inside if inside.is_dir() else package.parent / "web" / "dist"


def page_routes() -> APIRouter:
    """The page, and the API's documentation at ``/docs``."""
    router = APIRouter(include_in_schema=False)

    async def index() -> Response:
        return _file("index.html")

    for address in ADDRESSES:
        router.add_api_route(address, index)

    @router.get("/docs")
    async def docs() -> Response:
        return _file("docs.html")

    @router.get("/favicon.ico")
    async def favicon() -> Response:
        return _file("favicon.svg")

    return router


class _BuiltFiles(StaticFiles):
    """Files of a folder that may come later: until then there are none."""

    async def check_config(self) -> None:
        """Nothing: a missing folder is no fault of a request."""


def lost_page(request: Request) -> Response | None:
    """The page for a browser that goes to an address that there is not: its router says so. None: no such case."""
    goes_there = request.method in READING and "text/html" in request.headers.get("accept", "")
    return _file("index.html", 404) if goes_there and not request.url.path.startswith((*GUARDED, "/web/")) else None


def static_files() -> StaticFiles:
    """Scripts, style sheets and images of the pages."""
    return _BuiltFiles(directory=web_folder(), check_dir=False)


def _file(name: str, status: int = 200) -> Response:
    path = web_folder() / name
    return FileResponse(path, status) if path.is_file() else HTMLResponse(MISSING.format(escape(_state())), 503)


def _state() -> str:
    """What is done about the missing page."""
    try:
        return (web_folder().parent / "dist.state").read_text(encoding="utf-8")
    except OSError:
        return "it was never built; python web/build.py builds it"
