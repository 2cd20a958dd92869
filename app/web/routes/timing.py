"""``/api/v1/timing`` for pages and programs, ``/metrics`` for Prometheus: the same histograms.

Writing the text for Prometheus takes tens of milliseconds, so it runs in a thread and delays no page.
"""

from fastapi import APIRouter, Request, Response
from prometheus_client.exposition import choose_encoder
from prometheus_client.registry import CollectorRegistry

from app.web.blackboard import Blackboard
from app.web.health.monitor import HealthMonitor
from app.web.live.connection import Live
from app.web.metrics import ServiceCollector
from app.web.reports.timing import Timing, timing_from


def timing_routes(blackboard: Blackboard, monitor: HealthMonitor, live: Live) -> APIRouter:
    """Histograms of the tasks' times and of the lags."""
    router = APIRouter(tags=["timing"])
    registry = CollectorRegistry()
    registry.register(ServiceCollector(blackboard, monitor, live))
    shutter_delay_ms = blackboard.camera.shutter_delay_ms

    @router.get("/api/v1/timing")
    async def timing() -> Timing:
        """Histograms and quantiles of the times of every task, and of the lags A, B and C, since the start."""
        return timing_from(blackboard.timings(), shutter_delay_ms)

    @router.get(
        "/metrics",
        response_class=Response,
        responses={200: {"content": {"text/plain": {}}, "description": "Prometheus' text format, or OpenMetrics"}},
    )
    def metrics(request: Request) -> Response:
        """Metrics for Prometheus; tasks that do not report are left out."""
        encode, kind = choose_encoder(request.headers.get("accept", ""))
        return Response(encode(registry), headers={"content-type": kind})

    return router
