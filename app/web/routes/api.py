"""``/api/v1``: status, field and the newest picture."""

from fastapi import APIRouter, HTTPException, Response

from app.web.blackboard import Blackboard
from app.web.health.monitor import HealthMonitor
from app.web.problems import MEDIA_TYPE, ProblemDetails
from app.web.reports.field import Field, field_from
from app.web.reports.status import Status, status_from
from vision_core.native.opencv import encode_jpeg

SNAPSHOT_QUALITY = 92


def api_routes(blackboard: Blackboard, monitor: HealthMonitor) -> APIRouter:
    """Status, field, newest picture."""
    router = APIRouter(prefix="/api/v1", tags=["service"])
    field = field_from(blackboard.service)

    @router.get("/status")
    async def status() -> Status:
        """The whole service at this instant: state, cameras, clients, lags, processes."""
        snapshot = blackboard.read()
        return status_from(snapshot, monitor.judge(snapshot))

    @router.get("/field")
    async def field_() -> Field:
        """The geometry of the field, which stays the same while the service runs."""
        return field

    @router.get(
        "/snapshot.jpg",
        response_class=Response,
        responses={
            200: {"content": {"image/jpeg": {}}, "description": "The newest picture in full size"},
            503: {
                "content": {MEDIA_TYPE: {"schema": ProblemDetails.model_json_schema()}},
                "description": "No image yet",
            },
        },
    )
    def snapshot_jpg() -> Response:
        """The newest picture in full size; the header ``X-Frame-Number`` is the number of its frame."""
        picture = blackboard.picture()
        if picture is None:
            raise HTTPException(503, "no image yet")
        headers = {"X-Frame-Number": str(picture.number)}
        return Response(encode_jpeg(picture.pixels, SNAPSHOT_QUALITY), media_type="image/jpeg", headers=headers)

    return router
