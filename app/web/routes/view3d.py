"""``/view3d/``: viser's page, from the installed package, and its WebSocket."""

from importlib.util import find_spec
from pathlib import Path

from fastapi import APIRouter, WebSocket
from fastapi.responses import FileResponse

from app.web.view3d.view import View3D

PAGE_POLICY = (
    "default-src 'self' 'unsafe-inline' 'unsafe-eval' blob: data:; connect-src 'self' data: blob:; object-src 'none'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)
"""viser's page is one file with its scripts inside; it may load nothing from elsewhere."""


def view3d_page() -> Path:
    """viser's page. viser itself is not imported: that takes a second."""
    package = find_spec("viser")
    assert package is not None
    assert package.origin is not None
    return Path(package.origin).parent / "client" / "build" / "index.html"


def view3d_routes(view: View3D) -> APIRouter:
    """The 3D view."""
    router = APIRouter(include_in_schema=False)
    page = view3d_page()

    @router.get("/view3d/")
    async def index() -> FileResponse:
        return FileResponse(page, headers={"Content-Security-Policy": PAGE_POLICY})

    async def relay(browser: WebSocket) -> None:
        await view.relay(browser)

    router.add_api_websocket_route("/view3d", relay)
    router.add_api_websocket_route("/view3d/", relay)
    return router
