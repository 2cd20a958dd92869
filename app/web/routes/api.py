"""``/api/v1``: status, field and the newest picture."""

import re
import time
from dataclasses import replace
from datetime import datetime
from functools import lru_cache
from http import HTTPStatus
from pathlib import Path
from typing import Any

from fastapi import APIRouter, HTTPException, Request, Response
from msgspec import json, structs

from app.web.auth.identity import Role, identity_of
from app.web.blackboard import Blackboard, Picture
from app.web.cached import Cached
from app.web.configuration.configuration import Configuration
from app.web.health.monitor import HealthMonitor
from app.web.problems import PROBLEM, RequestRefused
from app.web.reports.field import Field, field_from
from app.web.reports.status import Status, status_from
from vision_core.clock import seconds_between
from vision_core.native.opencv import encode_jpeg, encode_png
from vision_core.settings.schema import MatchSettings, MirrorSettings

SNAPSHOT_QUALITY = 92
STATUS_EVERY_S = 0.1
"""A status is at most so old."""


def api_routes(blackboard: Blackboard, monitor: HealthMonitor, configuration: Configuration) -> APIRouter:
    """Status, field, newest picture."""
    router = APIRouter(prefix="/api/v1", tags=["service"])
    service = blackboard.service

    def status_now() -> bytes:
        snapshot = blackboard.read()
        return status_from(snapshot, monitor.judge(snapshot)).model_dump_json().encode()

    newest_status = Cached(status_now, STATUS_EVERY_S)

    @router.get("/status", response_model=Status)
    async def status() -> Response:
        """The whole service at this instant: state, cameras, clients, lags, processes."""
        return Response(await newest_status.get(), media_type="application/json")

    @lru_cache(maxsize=4)
    def field_of(live: bytes) -> Field:
        match, mirror = json.decode(live, type=tuple[MatchSettings, MirrorSettings])
        return field_from(replace(service, settings=structs.replace(service.settings, match=match, mirror=mirror)))

    @router.get("/field")
    def field() -> Field:
        """The geometry of the field and who wears which marker; a change of sides or teams changes it."""
        settings = configuration.settings
        return field_of(json.encode((settings.match, settings.mirror)))

    def newest_picture(request: Request) -> Picture:
        """The newest picture, for who may see it at once."""
        if configuration.settings.match.mode == "match" and identity_of(request).role is not Role.OPERATOR:
            raise RequestRefused(
                HTTPStatus.FORBIDDEN,
                "the newest picture",
                found="a match, in which only the operator sees where everything is now",
                accepted="the operator's session or token; on the page the picture comes late",
            )
        picture = blackboard.picture()
        if picture is None:
            raise HTTPException(503, "no image yet")
        return picture

    @router.get("/snapshot.jpg", response_class=Response, responses=_pictures("image/jpeg"))
    def snapshot_jpg(request: Request) -> Response:
        """The newest picture in full size; the header ``X-Frame-Number`` is the number of its frame."""
        picture = newest_picture(request)
        headers = {"X-Frame-Number": str(picture.number)}
        return Response(encode_jpeg(picture.pixels, SNAPSHOT_QUALITY), media_type="image/jpeg", headers=headers)

    @router.get("/snapshot.png", response_class=Response, responses=_pictures("image/png"))
    def snapshot_png(request: Request) -> Response:
        """The same without loss, as a file that is named after its source and the time of day."""
        picture = newest_picture(request)
        name = file_name(service.settings.source.uri, time.time() - seconds_between(picture.grabbed, blackboard.now()))
        headers = {
            "X-Frame-Number": str(picture.number),
            "Content-Disposition": f'attachment; filename="{name}"',
        }
        return Response(encode_png(picture.pixels), media_type="image/png", headers=headers)

    return router


def file_name(uri: str, at_s: float) -> str:
    """Name of a snapshot: its source, and the local time of day [s since 1970] to the millisecond."""
    kind, _, rest = uri.partition(":")
    source = Path(rest).stem if kind == "file" else uri
    clean = re.sub(r"[^A-Za-z0-9]+", "-", source).strip("-") or kind
    at = datetime.fromtimestamp(at_s).astimezone()
    return f"{clean[:60]}-{at:%Y%m%d-%H%M%S}-{at.microsecond // 1000:03d}.png"


def _pictures(media_type: str) -> dict[int | str, dict[str, Any]]:
    """The answers of a route that gives a picture, for the documentation."""
    return {
        200: {"content": {media_type: {}}, "description": "The newest picture in full size"},
        403: PROBLEM | {"description": "In a match only the operator sees where everything is now"},
        503: PROBLEM | {"description": "No image yet"},
    }
