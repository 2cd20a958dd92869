"""``/api/v1/calibration/mirror``: fit the mirror of the on-board cameras to pairs. Nothing takes effect here.

A fit runs as the other calibrations do: one at a time, in a process of its own; ``GET /api/v1/calibration`` says how
far it is and has the result.
"""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter
from pydantic import ConfigDict, Field

from app.web.calibration.job import CameraCalibration
from app.web.configuration.configuration import Configuration
from app.web.problems import RequestRefused
from app.web.reports.base import Report
from app.web.reports.calibration import CalibrationReport, calibration_from
from app.web.venue.asking import refused
from vision_core.calibration.job import MirrorJob, NamedPair
from vision_core.calibration.mirror.fit import focal_prior
from vision_core.calibration.mirror.pairs import MAX_BYTES, MAX_PAIRS, Pairs, pairs_from_text, pairs_of
from vision_core.calibration.mirror.rounding import Rounding

Name = Annotated[str, Field(max_length=60)]


class TypedPair(Report):
    """A radius in the on-board picture and the distance on the floor from the robot's center."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    r_px: float
    r_mm: float
    name: Name = ""
    """What messages call it; empty: "row 1" and so on."""


class MirrorRequest(Report):
    """Pairs, typed or as text, and what is known of the on-board camera."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    pairs: Annotated[tuple[TypedPair, ...], Field(max_length=MAX_PAIRS)] = ()
    text: Annotated[str, Field(max_length=MAX_BYTES)] = ""
    """Pasted, or a CSV file: radius [px] and distance [mm], or a header that names the units. Beside pairs or alone."""
    rounding: Rounding = Rounding.AUTO
    """Are radii cut to whole numbers? int: yes, as in ``see``; exact: no; auto: if all of them are whole."""
    focal_px: Annotated[float, Field(ge=1.0, le=1e5)] | None = None
    """Focal length of the on-board camera; null: not known."""
    focal_deviation_px: Annotated[float, Field(ge=0.0, le=1e5)] | None = None
    """Its standard deviation; null: a tenth of it."""


def add_mirror_routes(router: APIRouter, job: CameraCalibration, configuration: Configuration) -> None:
    """Fitting a mirror."""

    @router.post("/mirror", status_code=HTTPStatus.ACCEPTED)
    def fit(wanted: MirrorRequest) -> CalibrationReport:
        """Begins with a mirror; GET says how far it is, and has curve, band and residuals then. Nothing changes.
        A pair that is none is refused at once, with its row or line."""
        pairs = _pairs(wanted)
        rows = zip(pairs.radii_px.tolist(), pairs.distances_mm.tolist(), pairs.names, strict=True)
        prior = None if wanted.focal_px is None else focal_prior(wanted.focal_px, wanted.focal_deviation_px)
        job.fit(MirrorJob(configuration.settings, tuple(NamedPair(*row) for row in rows), pairs.rounding, prior))
        return calibration_from(job, configuration.settings)


def _pairs(wanted: MirrorRequest) -> Pairs:
    """Raises RequestRefused naming the row or line."""
    if wanted.focal_px is None and wanted.focal_deviation_px is not None:
        raise RequestRefused(
            HTTPStatus.UNPROCESSABLE_ENTITY,
            "focal_deviation_px",
            found="no focal_px",
            accepted="focal_px with it",
            field="focal_px",
        )
    with refused(HTTPStatus.UNPROCESSABLE_ENTITY, "pairs"):
        rows = [(pair.r_px, pair.r_mm) for pair in wanted.pairs]
        names = [pair.name or f"row {number}" for number, pair in enumerate(wanted.pairs, start=1)]
        typed = pairs_of(rows, names, wanted.rounding)
    if not wanted.text.strip():
        return typed
    with refused(HTTPStatus.UNPROCESSABLE_ENTITY, "text"):
        pasted = pairs_from_text(wanted.text, wanted.rounding, asked="the text")
    return typed.joined(pasted) if len(typed) else pasted
