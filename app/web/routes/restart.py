"""``/api/v1/restart``: starts the whole service again, with what was changed since and with its clients."""

from http import HTTPStatus

from fastapi import APIRouter, Request

from app.web.auth.identity import identity_of
from app.web.blackboard import Blackboard
from app.web.problems import REFUSED
from app.web.reports.processes import RestartReport, restart_from
from vision_core.rtdb import records
from vision_core.rtdb.infos import RestartRequest
from vision_core.rtdb.store import Store


def restart_routes(store: Store, blackboard: Blackboard) -> APIRouter:
    """Asking for a restart, and what became of it."""
    router = APIRouter(prefix="/api/v1", tags=["settings"])
    requests = records.RESTART_REQUEST.writer(store)

    @router.get("/restart")
    def restart() -> RestartReport:
        """What became of the newest request to restart the service."""
        return restart_from(blackboard.read())

    @router.post("/restart", status_code=HTTPStatus.ACCEPTED, responses=REFUSED)
    def request_restart(request: Request) -> RestartReport:
        """Asks for a restart of the whole service: files are read again, and settings that wait for a restart take
        effect. First it is checked that the service would start, while it goes on; if not, it stays as it is and GET
        says why. Clients keep their sessions, ports and Time; they get no views for a few seconds."""
        now = blackboard.now()
        requests.write(RestartRequest(who=identity_of(request).name), now, now)
        return restart_from(blackboard.read())

    return router
