"""``/healthz`` and ``/readyz``, for containers, load balancers and scripts."""

from fastapi import APIRouter, Response, status

from app.web.blackboard import Blackboard
from app.web.health.monitor import HealthMonitor, HealthState
from app.web.reports.base import Report


class Liveness(Report):
    """The web process answers."""

    status: str


class Readiness(Report):
    """Whether robots are served, and how well."""

    state: HealthState
    """ready; degraded: robots are served, but worse than they should be; not_ready: no robot is served."""
    ready: bool
    """Robots are served: true for ready and degraded."""
    reasons: list[str]
    """Why no robot is served; empty when ready is true."""
    degraded: list[str]
    """What is worse than it should be, one sentence for each cause."""
    advice: list[str]
    """What to do about each of ``reasons``, then about each of ``degraded``."""


def health_routes(blackboard: Blackboard, monitor: HealthMonitor) -> APIRouter:
    """Liveness of the web process, readiness of the service."""
    router = APIRouter(tags=["health"])

    @router.get("/healthz")
    async def healthz() -> Liveness:
        """Liveness of the web process: always 200."""
        return Liveness(status="ok")

    @router.get("/readyz", responses={503: {"model": Readiness, "description": "No robot is served, and why"}})
    async def readyz(response: Response) -> Readiness:
        """Readiness of the service: 200 when robots are served, well or badly; 503 when they are not."""
        health = monitor.judge(blackboard.read())
        if not health.is_ready:
            response.status_code = status.HTTP_503_SERVICE_UNAVAILABLE
        return Readiness(
            state=health.state,
            ready=health.is_ready,
            reasons=[cause.sentence for cause in health.reasons],
            degraded=[cause.sentence for cause in health.degradations],
            advice=[cause.advice for cause in health.causes],
        )

    return router
