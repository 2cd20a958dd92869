"""``/api/v1/timing`` for pages and programs, ``/metrics`` for Prometheus: the same histograms.

Both take tens of milliseconds, so they are made in a thread and at most once per period, however many ask.
"""

from fastapi import APIRouter, Request, Response
from prometheus_client.exposition import choose_encoder
from prometheus_client.registry import CollectorRegistry

from app.web.blackboard import Blackboard
from app.web.cached import Cached
from app.web.health.monitor import HealthMonitor
from app.web.live.connection import Live
from app.web.metrics import ServiceCollector
from app.web.reports.timing import Timing, timing_from

TIMING_EVERY_S, METRICS_EVERY_S = 0.5, 1.0
MAX_KINDS = 8
"""Forms of the text that are kept."""


def timing_routes(blackboard: Blackboard, monitor: HealthMonitor, live: Live) -> APIRouter:
    """Histograms of the tasks' times and of the lags."""
    router = APIRouter(tags=["timing"])
    registry = CollectorRegistry()
    registry.register(ServiceCollector(blackboard, monitor, live))
    shutter_delay_ms = blackboard.camera.shutter_delay_ms

    times = Cached(
        lambda: timing_from(blackboard.timings(), shutter_delay_ms).model_dump_json().encode(), TIMING_EVERY_S
    )
    texts: dict[str, Cached] = {}

    @router.get("/api/v1/timing", response_model=Timing)
    async def timing() -> Response:
        """Histograms and quantiles of the times of every task, and of the lags A, B and C, since the start."""
        return Response(await times.get(), media_type="application/json")

    @router.get(
        "/metrics",
        response_class=Response,
        responses={200: {"content": {"text/plain": {}}, "description": "Prometheus' text format, or OpenMetrics"}},
    )
    async def metrics(request: Request) -> Response:
        """Metrics for Prometheus; tasks that do not report are left out."""
        encode, kind = choose_encoder(request.headers.get("accept", ""))
        if len(texts) > MAX_KINDS:
            texts.clear()
        text = texts.setdefault(kind, Cached(lambda: encode(registry), METRICS_EVERY_S))
        return Response(await text.get(), headers={"content-type": kind})

    return router
