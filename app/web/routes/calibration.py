"""``/api/v1/calibration``: the camera by the field's painted lines in pictures, and its lens by pictures of a board."""

import asyncio
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import Path
from typing import Annotated, Any, Literal

from fastapi import APIRouter, HTTPException, Query, Request, Response
from msgspec import to_builtins
from pydantic import ConfigDict, Field

from app.web.blackboard import Blackboard
from app.web.calibration.ceiling import keep_ceiling
from app.web.calibration.job import CameraCalibration
from app.web.calibration.pictures import Shown
from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import setting
from app.web.middleware.gate import FILE_BODY
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.calibration import CalibrationReport, Point, calibration_from
from app.web.reports.changes import ChangeReport
from app.web.routes.change import change
from app.web.routes.mirror_calibration import add_mirror_routes
from vision_core.calibration.board.board import BOARDS
from vision_core.calibration.board.result import LensCalibration
from vision_core.calibration.board.sheet import FORMS
from vision_core.calibration.job import CameraJob, LensJob
from vision_core.calibration.result import Calibration

MEDIA = {"pdf": "application/pdf", "svg": "image/svg+xml", "png": "image/png"}


class CalibrationRequest(Report):
    """What a calibration begins with."""

    model_config = ConfigDict(extra="forbid")

    corners_px: Annotated[list[Point], Field(min_length=4, max_length=4)] | None = None
    """Outer corners of the field's lines: left top, right top, right bottom, left bottom. They need not be exact."""
    find: bool = False
    """Without corners: search the field in the pictures. Otherwise the camera in use is the first guess."""
    height_m: Annotated[float, Field(ge=0.1, le=100.0)] | None = None
    """Height of the camera by tape measure."""
    swap_ends: bool = False
    """The field's left end is the other one: lines do not tell."""


def calibration_routes(blackboard: Blackboard, configuration: Configuration) -> APIRouter:
    """Pictures, calibrating by them, taking the result over."""
    router = APIRouter(prefix="/api/v1/calibration", tags=["calibration"], responses=REFUSED)
    database = Path(blackboard.service.database)
    job = CameraCalibration(database.parent / f"{database.stem}-calibration")
    _picture_routes(router, job, blackboard, configuration)
    _job_routes(router, job, configuration)
    _end_routes(router, job, configuration)
    add_mirror_routes(router, job, blackboard, configuration)
    return router


def _picture_routes(
    router: APIRouter, job: CameraCalibration, blackboard: Blackboard, configuration: Configuration
) -> None:
    """The pictures, and a board to print."""

    @router.get("")
    def calibration() -> CalibrationReport:
        """The pictures, how far the newest calibration is, and its result."""
        return calibration_from(job, configuration.settings)

    @router.post("/pictures", openapi_extra=FILE_BODY)
    async def add(request: Request, of: Shown, name: Annotated[str, Query(max_length=200)]) -> CalibrationReport:
        """Takes one picture's file, at most 32 MB, as application/octet-stream. A bad one is refused with its name,
        and the others stay. Beside an on-board picture the ceiling camera's newest one is kept."""
        job.check_idle()
        data = await request.body()
        number = await asyncio.to_thread(job.pictures.add, of, name, data)
        if of is Shown.ONBOARD:
            await asyncio.to_thread(keep_ceiling, job.pictures, number, blackboard)
        job.forget(of)
        return calibration_from(job, configuration.settings)

    @router.post("/pictures/camera")
    def take(of: Shown) -> CalibrationReport:
        """Takes the newest picture of the camera in use, beside those that are there."""
        picture = blackboard.picture()
        if picture is None:
            raise HTTPException(503, "no image yet")
        job.forget(of)
        job.pictures.add_pixels(of, f"frame-{picture.number}.png", picture.pixels)
        return calibration_from(job, configuration.settings)

    @router.delete("/pictures")
    def clear(of: Shown) -> CalibrationReport:
        """Takes all pictures of the field, or of a board, out."""
        job.forget(of)
        job.pictures.clear(of)
        return calibration_from(job, configuration.settings)

    @router.delete("/pictures/{number}")
    def remove(number: int) -> CalibrationReport:
        """Takes a picture out."""
        kind = job.pictures.picture(number).kind
        job.forget(kind)
        job.pictures.remove(number)
        return calibration_from(job, configuration.settings)

    @router.get("/pictures/{number}.jpg", response_class=Response)
    def shown(number: int, small: bool = False) -> Response:
        """A picture as a browser shows it."""
        return Response(job.pictures.shown(number, small=small), media_type="image/jpeg")

    @router.get("/board.{form}", response_class=Response)
    def board(form: Literal["pdf", "svg", "png"], paper: Literal["A4", "A3"] = "A4") -> Response:
        """A board to print at 100 % (pdf, svg), or to show on a flat screen (png)."""
        name = f'attachment; filename="pslv-board-{paper}.{form}"'
        data = FORMS[form](BOARDS[paper])
        return Response(data, media_type=MEDIA[form], headers={"content-disposition": name})


def _job_routes(router: APIRouter, job: CameraCalibration, configuration: Configuration) -> None:
    """What takes a while."""

    @router.post("", status_code=HTTPStatus.ACCEPTED)
    def start(wanted: CalibrationRequest) -> CalibrationReport:
        """Begins with the camera; GET says how far it is. The service goes on meanwhile, and nothing changes.
        A lens that was measured with a board and taken over holds."""
        corners = tuple(wanted.corners_px) if wanted.corners_px is not None else None
        job.calibrate(
            CameraJob(
                settings=configuration.settings,
                pictures=job.pictures.files(Shown.FIELD),
                corners_px=corners,
                finds=wanted.find,
                height_m=wanted.height_m,
                swaps_ends=wanted.swap_ends,
                frees_measures=False,
            )
        )
        return calibration_from(job, configuration.settings)

    @router.post("/lens", status_code=HTTPStatus.ACCEPTED)
    def measure() -> CalibrationReport:
        """Begins with the lens, by the pictures of a board; GET says how far it is."""
        job.measure(LensJob(job.pictures.files(Shown.BOARD)))
        return calibration_from(job, configuration.settings)

    @router.delete("")
    def cancel() -> CalibrationReport:
        """Ends the calibration that runs; nothing is kept of it."""
        job.cancel()
        return calibration_from(job, configuration.settings)


def _end_routes(router: APIRouter, job: CameraCalibration, configuration: Configuration) -> None:
    """What was found becomes the setting."""

    @router.post("/accept")
    def accept(request: Request) -> ChangeReport:
        """Makes the calibrated camera the setting, as one change that can be undone. It waits for a restart."""
        result = job.result
        _check(result, "take the camera over")
        assert result is not None
        lens = {f"camera.pinhole.{key}": value for key, value in to_builtins(result.camera).items()}
        count = len(job.pictures.of(Shown.FIELD))
        pictures = "one picture" if count == 1 else f"{count} pictures"
        what = f"camera calibrated by {pictures}: {result.rms_px:.2f} px"
        return _changed(configuration, request, {"camera.model": "pinhole", **lens}, what)

    @router.post("/lens/accept")
    def accept_lens(request: Request) -> ChangeReport:
        """Makes the measured lens the setting, which holds in calibrations of the camera from now on."""
        result = job.lens
        _check(result, "take the lens over")
        assert result is not None
        what = f"lens measured by {len(result.pictures)} pictures of a board: {result.rms_px:.2f} px"
        return _changed(configuration, request, {"camera.lens": to_builtins(result.lens)}, what)

    @router.delete("/lens")
    def forget_lens(request: Request) -> ChangeReport:
        """Takes the lens out of the settings again: lines tell it anew. One of a venue's file stays."""
        return _changed(configuration, request, {"camera.lens": None}, "without the measured lens")


def _check(result: Calibration | LensCalibration | None, what: str) -> None:
    """Raise RequestRefused for a result that is not to be trusted."""
    if result is None or not result.accepted:
        found = "; ".join(str(reason) for reason in result.reasons) if result else "no result"
        raise RequestRefused(HTTPStatus.CONFLICT, what, found=found, accepted="a good calibration")


def _changed(configuration: Configuration, request: Request, values: Mapping[str, Any], what: str) -> ChangeReport:
    return change(configuration, {setting(key): value for key, value in values.items()}, request, what)
