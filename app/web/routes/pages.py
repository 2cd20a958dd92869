"""The page and its static files, served as they are in the repository."""

from functools import cache
from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse
from starlette.staticfiles import StaticFiles

import app


@cache
def web_folder() -> Path:
    """The folder of the page's files: inside the installed package, or beside it in a checkout."""
    assert app.__file__ is not None
    package = Path(app.__file__).parent
    inside = package / "web" / "static"
    return inside if inside.is_dir() else package.parent / "web"


def page_routes() -> APIRouter:
    """The page at ``/`` and the API's documentation at ``/docs``."""
    router = APIRouter(include_in_schema=False)

    @router.get("/")
    async def index() -> FileResponse:
        return FileResponse(web_folder() / "index.html")

    @router.get("/docs")
    async def docs() -> FileResponse:
        return FileResponse(web_folder() / "docs.html")

    @router.get("/favicon.ico")
    async def favicon() -> FileResponse:
        return FileResponse(web_folder() / "favicon.svg")

    return router


def static_files() -> StaticFiles:
    """Scripts, style sheets and images of the pages."""
    return StaticFiles(directory=web_folder())
