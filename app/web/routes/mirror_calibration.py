"""``/api/v1/calibration/mirror``: pairs from on-board pictures, and a mirror through pairs. Nothing takes effect here.

A fit and the search for pairs run as the other calibrations do: one at a time, in a process of their own; ``GET
/api/v1/calibration`` says how far they are and has the result. An edge and a rim are answered at once.
"""

import math
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, HTTPException
from pydantic import ConfigDict, Field

from app.web.blackboard import Blackboard
from app.web.calibration.ceiling import keep_ceiling
from app.web.calibration.job import CameraCalibration
from app.web.calibration.pictures import Shown
from app.web.configuration.configuration import Configuration
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.calibration import CalibrationReport, calibration_from
from app.web.venue.asking import asked, refused
from vision_core.calibration.job import EdgeJob, MirrorJob, NamedPair, PairsJob, Rim, RimJob
from vision_core.calibration.mirror.fit import focal_prior
from vision_core.calibration.mirror.pairs import MAX_BYTES, MAX_PAIRS, Pairs, SharedError, pairs_from_text, pairs_of
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.calibration.mirror.target_edge import RadialEdge
from vision_core.types.objects import Team
from vision_core.types.tables import MAX_NUMBERS

Name = Annotated[str, Field(max_length=100)]


class TypedPair(Report):
    """A radius in the on-board picture and the distance on the floor from the robot's center."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    r_px: float
    r_mm: float
    name: Name = ""
    """What messages call it; empty: "row 1" and so on."""
    shared_mm: Annotated[float, Field(ge=0.0, le=100.0)] = 0.0
    """Standard deviation of an error of the distance that all pairs which have one share; 0: measured alone."""
    shared_px: Annotated[float, Field(ge=0.0, le=100.0)] = 0.0
    """The same of the radius."""


Place = tuple[float, float]
Scale = Annotated[float, Field(ge=0.01, le=100.0)]


class AroundRequest(Report):
    """An on-board picture, and what stands around the robot."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    picture: int
    """Number of a picture of kind onboard."""
    team: Team = Team.BLUE
    number: Annotated[int, Field(ge=1, le=MAX_NUMBERS)] = 1
    """Of the robot: where it stands, and what around it, is measured in the ceiling camera's picture beside it."""
    text: Annotated[str, Field(max_length=MAX_BYTES)] = ""
    """Directions [deg, anticlockwise from the heading] and distances [mm] as CSV, instead of measuring them."""
    center_px: Place | None = None
    """Of the mirror's image; null: the picture's middle."""
    scale: Scale = 1.0
    """Pixels of the picture per pixel of equation 1."""


class RimRequest(Report):
    """Where the mirror is in an on-board picture."""

    model_config = ConfigDict(extra="forbid")

    picture: int
    """Number of a picture of kind onboard."""


class RimReport(Report):
    """The mirror's round rim, in the picture."""

    center_px: Place
    radius_px: float


class EdgeRequest(Report):
    """Where the edge of a target is in an on-board picture."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    picture: int
    """Number of a picture of kind onboard."""
    place_px: Place | None = None
    """A click near the edge; null: the strongest edge in the direction."""
    direction_deg: float = 0.0
    """Anticlockwise from the heading, which is up."""
    center_px: Place | None = None
    scale: Scale = 1.0


class EdgeReport(Report):
    """An edge."""

    r_px: float
    """Its distance from the center, in pixels of equation 1."""
    direction_deg: float
    place_px: Place
    """In the picture."""


class MirrorRequest(Report):
    """Pairs, typed, as text or found in pictures, and what is known of the on-board camera."""

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


class PastedPairs(Report):
    """Pairs as text, pasted or of a file."""

    model_config = ConfigDict(extra="forbid")

    text: Annotated[str, Field(max_length=MAX_BYTES)]


class PairsReport(Report):
    """The pairs of a text, with the lines that they stand in as names."""

    pairs: list[TypedPair]


def add_mirror_routes(
    router: APIRouter, job: CameraCalibration, blackboard: Blackboard, configuration: Configuration
) -> None:
    """Fitting a mirror."""

    @router.post("/pictures/{number}/ceiling")
    def ceiling(number: int) -> CalibrationReport:
        """Keeps the newest picture of the camera in use beside an on-board picture, as that of the same instant. The
        one that was newest when the on-board picture was given is there before."""
        job.pictures.file(number, Shown.ONBOARD)
        if not keep_ceiling(job.pictures, number, blackboard):
            raise HTTPException(HTTPStatus.SERVICE_UNAVAILABLE, "no image yet")
        return calibration_from(job, configuration.settings)

    @router.post("/mirror", status_code=HTTPStatus.ACCEPTED)
    def fit(wanted: MirrorRequest) -> CalibrationReport:
        """Begins with a mirror; GET says how far it is, and has curve, band and residuals then. Nothing changes.
        A pair that is none is refused at once, with its row or line."""
        pairs = _pairs(wanted)
        shared = [SharedError(*both) for both in pairs.shared.tolist()]
        rows = zip(pairs.radii_px.tolist(), pairs.distances_mm.tolist(), pairs.names, shared, strict=True)
        prior = None if wanted.focal_px is None else focal_prior(wanted.focal_px, wanted.focal_deviation_px)
        typed = tuple(NamedPair(*row) for row in rows)
        job.fit(MirrorJob(configuration.settings, typed, pairs.rounding, prior))
        return calibration_from(job, configuration.settings)

    @router.post("/mirror/around", status_code=HTTPStatus.ACCEPTED)
    def around(wanted: AroundRequest) -> CalibrationReport:
        """Begins to look for the edges of everything that stands around a robot; GET has hundreds of pairs then."""
        picture = job.pictures.file(wanted.picture, Shown.ONBOARD)
        ceiling = "" if wanted.text else str(job.pictures.ceiling(wanted.picture))
        settings, robot = configuration.settings, (wanted.team, wanted.number)
        job.look(PairsJob(settings, picture, wanted.text, ceiling, *robot, wanted.center_px, wanted.scale))
        return calibration_from(job, settings)

    @router.post("/mirror/rim")
    def rim(wanted: RimRequest) -> RimReport:
        """Finds the mirror's rim before the dark outside: its middle is the center of radii."""
        found = asked(RimJob(job.pictures.file(wanted.picture, Shown.ONBOARD)), Rim, "the mirror's rim")
        return RimReport(center_px=(found.column, found.row), radius_px=found.radius_px)

    @router.post("/mirror/edge")
    def edge(wanted: EdgeRequest) -> EdgeReport:
        """Finds the edge of a target in an on-board picture, to a part of a pixel: the radius of a pair."""
        picture = job.pictures.file(wanted.picture, Shown.ONBOARD)
        direction = math.radians(wanted.direction_deg)
        found = asked(EdgeJob(picture, wanted.center_px, wanted.place_px, direction), RadialEdge, "the edge")
        return EdgeReport(
            r_px=found.radius_px / wanted.scale,
            direction_deg=math.degrees(found.direction_rad),
            place_px=found.place_px,
        )

    @router.post("/mirror/pairs", responses=REFUSED)
    def pairs_of_text(pasted: PastedPairs) -> PairsReport:
        """The pairs of a text, for a look before they are fitted. Refused with the line that is no pair."""
        with refused(HTTPStatus.UNPROCESSABLE_ENTITY, "text"):
            pairs = pairs_from_text(pasted.text, asked="the text")
        rows = zip(pairs.radii_px.tolist(), pairs.distances_mm.tolist(), pairs.names, strict=True)
        return PairsReport(pairs=[TypedPair(r_px=px, r_mm=mm, name=name) for px, mm, name in rows])


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
        typed = pairs_of(rows, names, wanted.rounding, [SharedError(p.shared_mm, p.shared_px) for p in wanted.pairs])
    if not wanted.text.strip():
        return typed
    with refused(HTTPStatus.UNPROCESSABLE_ENTITY, "text"):
        pasted = pairs_from_text(wanted.text, wanted.rounding, asked="the text")
    return typed.joined(pasted) if len(typed) else pasted
