"""``/healthz`` and ``/readyz``, for containers, balancers and scripts."""

from fastapi import APIRouter, Response, status

from app.web.blackboard import Blackboard
from app.web.reports.base import Report
from app.web.reports.degradation import degradations
from app.web.reports.readiness import reasons_not_ready


class Health(Report):
    """The web process answers."""

    status: str


class Readiness(Report):
    """Are robots served?"""

    ready: bool
    reasons: list[str]
    """Why not, in words."""
    degraded: list[str]
    """What is worse than it should be although robots are served, in words."""


def health_routes(blackboard: Blackboard) -> APIRouter:
    """Is it alive, is it ready."""
    router = APIRouter(tags=["health"])

    @router.get("/healthz")
    async def healthz() -> Health:
        """Does the web process answer? Always 200."""
        return Health(status="ok")

    @router.get("/readyz", responses={503: {"model": Readiness, "description": "Not ready, and why"}})
    async def readyz(response: Response) -> Readiness:
        """Are robots served right now? 200, or 503 with the reasons."""
        readings = blackboard.read()
        reasons = reasons_not_ready(readings)
        if reasons:
            response.status_code = status.HTTP_503_SERVICE_UNAVAILABLE
        return Readiness(ready=not reasons, reasons=list(reasons), degraded=list(degradations(readings)))

    return router
