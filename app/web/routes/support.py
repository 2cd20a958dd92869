"""``/api/v1/log`` and ``/api/v1/support-bundle``: for whoever looks for what is wrong. Both need the operator."""

import threading

from fastapi import APIRouter, Query, Response

from app.web.blackboard import Blackboard
from app.web.configuration.configuration import Configuration
from app.web.health.monitor import HealthMonitor
from app.web.problems import REFUSED
from app.web.reports.log import LogReport, log_from
from app.web.support.bundle import CHANGES, bundle_name, bundle_of, gathered
from vision_core.rtdb.log_record import LogLevel

MAX_NAME = 80
ZIP = "application/zip"


def support_routes(blackboard: Blackboard, monitor: HealthMonitor, configuration: Configuration) -> APIRouter:
    """The log, and everything in one file."""
    router = APIRouter(prefix="/api/v1", tags=["support"])
    one_at_a_time = threading.Lock()

    @router.get("/log", responses=REFUSED)
    def log(level: LogLevel = LogLevel.INFO, process: str = Query(default="", max_length=MAX_NAME)) -> LogReport:
        """The newest lines that the processes printed: of a level and of worse ones, of one process or of all. It may
        contain addresses of people, so it is the operator's."""
        return log_from(blackboard.log(), level, process)

    @router.get(
        "/support-bundle",
        response_class=Response,
        responses=REFUSED | {200: {"content": {ZIP: {}}, "description": "A zip; its README.txt says what is in it"}},
    )
    def support_bundle() -> Response:
        """Everything that somebody needs who is to help: versions, settings, self-test, health, checks, processes,
        tasks, timing, log, changes and one picture; without passwords, tokens, keys and contacts of teams."""
        with one_at_a_time:
            changes = configuration.document.history(CHANGES)
            packed = bundle_of(gathered(blackboard, monitor.judge(blackboard.read()), changes))
        named = {"content-disposition": f'attachment; filename="{bundle_name()}"'}
        return Response(packed, media_type=ZIP, headers=named)

    return router
