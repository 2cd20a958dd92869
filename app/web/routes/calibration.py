"""``/api/v1/calibration``: calibrates the camera by the field's painted lines in one picture."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, HTTPException, Request, Response
from msgspec import to_builtins
from pydantic import ConfigDict, Field

from app.web.auth.identity import identity_of
from app.web.blackboard import Blackboard
from app.web.calibration.job import CameraCalibration
from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import setting
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.calibration import CalibrationReport, Point, calibration_from
from app.web.reports.changes import ChangeReport, change_from, not_made
from vision_core.calibration.job import CalibrationJob
from vision_core.native.opencv import encode_png


class CalibrationRequest(Report):
    """What a calibration begins with."""

    model_config = ConfigDict(extra="forbid")

    corners_px: Annotated[list[Point], Field(min_length=4, max_length=4)] | None = None
    """Outer corners of the field's lines: left top, right top, right bottom, left bottom. They need not be exact."""
    find: bool = False
    """Without corners: search the field in the picture. Otherwise the camera in use is the first guess."""
    height_m: Annotated[float, Field(ge=0.1, le=100.0)] | None = None
    """Height of the camera by tape measure."""
    swap_ends: bool = False
    """The field's left end is the other one: lines do not tell."""


def calibration_routes(blackboard: Blackboard, configuration: Configuration) -> APIRouter:
    """Taking a picture, calibrating by it, taking the result over."""
    router = APIRouter(prefix="/api/v1/calibration", tags=["calibration"])
    job = CameraCalibration()

    @router.get("")
    def calibration() -> CalibrationReport:
        """The picture, how far the newest calibration is, and its result."""
        return calibration_from(job)

    @router.post("/picture", responses=REFUSED)
    def take_picture() -> CalibrationReport:
        """Takes the newest picture to calibrate by."""
        picture = blackboard.picture()
        if picture is None:
            raise HTTPException(503, "no image yet")
        job.take(picture)
        return calibration_from(job)

    @router.get("/picture.png", response_class=Response, responses=REFUSED)
    def picture() -> Response:
        """The picture that is calibrated by."""
        if job.picture is None:
            raise RequestRefused(HTTPStatus.NOT_FOUND, "the picture", found="none", accepted="take a picture first")
        return Response(encode_png(job.picture.pixels), media_type="image/png")

    @router.post("", status_code=HTTPStatus.ACCEPTED, responses=REFUSED)
    def start(wanted: CalibrationRequest) -> CalibrationReport:
        """Begins; GET says how far it is. The service goes on meanwhile, and nothing changes."""
        height, width = job.picture.pixels.shape[:2] if job.picture is not None else (0, 0)
        corners = tuple(wanted.corners_px) if wanted.corners_px is not None else None
        job.start(
            CalibrationJob(
                settings=configuration.settings,
                size_px=(width, height),
                corners_px=corners,
                finds=wanted.find,
                height_m=wanted.height_m,
                swaps_ends=wanted.swap_ends,
            )
        )
        return calibration_from(job)

    @router.delete("", responses=REFUSED)
    def cancel() -> CalibrationReport:
        """Ends the calibration that runs; nothing is kept of it."""
        job.cancel()
        return calibration_from(job)

    @router.post("/accept", responses=REFUSED)
    def accept(request: Request) -> ChangeReport:
        """Makes the calibrated camera the setting, as one change that can be undone. It waits for a restart."""
        result = job.result
        if result is None or not result.accepted:
            found = "; ".join(str(reason) for reason in result.reasons) if result else "no result"
            raise RequestRefused(
                HTTPStatus.CONFLICT, "take the camera over", found=found, accepted="a good calibration"
            )
        camera = {f"camera.pinhole.{key}": value for key, value in to_builtins(result.camera).items()}
        values = {setting(key): value for key, value in {"camera.model": "pinhole", **camera}.items()}
        what = f"camera calibrated by frame {job.picture.number if job.picture else 0}: {result.rms_px:.2f} px"
        made = configuration.change(values, who=identity_of(request).name, what=what)
        return change_from(made) if made else not_made(configuration.revision, what)

    return router
