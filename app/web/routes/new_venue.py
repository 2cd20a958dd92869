"""``/api/v1/new-venue``: sets up a venue from pictures, step by step; everything of it is the operator's."""

import asyncio
from http import HTTPStatus
from pathlib import Path
from typing import Annotated, Any

import msgspec
from fastapi import APIRouter, HTTPException, Query, Request, Response
from pydantic import ConfigDict, Field

from app.web.blackboard import Blackboard
from app.web.configuration import sources
from app.web.configuration.configuration import Configuration
from app.web.middleware.gate import FILE_BODY
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.calibration import Point
from app.web.reports.changes import ChangeReport
from app.web.reports.new_venue import (
    ChoicesReport,
    ClassesReport,
    ClassReport,
    DifferenceReport,
    FieldMeasures,
    NewVenueReport,
    SampledReport,
    SavedReport,
    choices_from,
    venue_from,
)
from app.web.routes.change import change
from app.web.venue.asking import refused
from app.web.venue.desk import Desk
from app.web.venue.use import changes_to, differences
from vision_core.patterns.drawing import marker_svg
from vision_core.rtdb.infos import ServiceInfo
from vision_core.settings.layers import LayerKind
from vision_core.settings.schema import FieldSettings
from vision_core.setup.choices import pattern_choices, with_pattern, with_preset, without_sample
from vision_core.setup.draft import Draft
from vision_core.setup.jobs import Begin, CameraWish
from vision_core.setup.venue_file import save_venue, settings_of, venue_text
from vision_core.types.objects import Team
from vision_core.venues.loader import layers_of, own_venues_folder, settings_from_layers

Height = Annotated[float, Field(ge=0.1, le=100.0)]
OWN_FIELD = "ssl-2002"
"""The preset below a field whose measures were typed: it gives the mirror."""
CHOICES = {
    "name": "name",
    "about": "sentence about it",
    "source": "pictures come from",
    "preset": "field",
    "field": "measures of the field",
    "pattern": "markers",
    "robot_radius_m": "radius of the robots [m]:",
    "robot_height_m": "height of the markers [m]:",
    "numbers": "robots per team:",
    "ball_color": "ball",
    "ball_radius_m": "radius of the ball [m]:",
}
"""What somebody chooses, in words."""


class DraftPatch(Report):
    """What somebody chooses; what is left out stays."""

    model_config = ConfigDict(extra="forbid")

    seen: int | None = None
    """Number of the draft that was seen; null: whatever it is."""
    name: str | None = None
    about: str | None = None
    source: str | None = None
    """As ``source.uri``; "pictures": the given ones are played; empty: the file names none."""
    preset: str | None = None
    """A field preset: its measures replace those that were edited."""
    field: FieldMeasures | None = None
    """The field's own measures."""
    pattern: str | None = None
    """A marker pattern: the size of its robots replaces the one that was edited."""
    robot_radius_m: float | None = None
    robot_height_m: float | None = None
    numbers: int | None = None
    ball_color: str | None = None
    ball_radius_m: float | None = None


class RecognizeRequest(Report):
    """How the field is recognized."""

    model_config = ConfigDict(extra="forbid")

    height_m: Height | None = None
    """Of the camera, by tape measure."""


class PresetRequest(Report):
    """A field preset."""

    model_config = ConfigDict(extra="forbid")

    preset: str


class CameraRequest(Report):
    """How the camera is searched."""

    model_config = ConfigDict(extra="forbid")

    begin: Begin
    """find: search the painted lines; corners: painted lines, beginning with these; walls: corners alone."""
    corners_px: Annotated[list[Point], Field(min_length=4, max_length=4)] | None = None
    """Left top, right top, right bottom, left bottom."""
    height_m: Height | None = None
    swap_ends: bool = False
    measures: bool = False
    """Solve the field's measures too, except its length."""


class ColorsRequest(Report):
    """How the colors that were found are taken."""

    model_config = ConfigDict(extra="forbid")

    doubtful: bool = False
    """Take them although they are not clear enough: as a beginning, to which samples are added."""


class SampleRequest(Report):
    """A place in a picture whose color belongs to a class."""

    model_config = ConfigDict(extra="forbid")

    picture: int
    x: int
    y: int
    radius: Annotated[int, Field(ge=0, le=20)] = 2
    """The median of the square round the place is taken."""
    name: str
    """Of the class; none: what must not be found."""


class SaveRequest(Report):
    """How the venue is saved."""

    model_config = ConfigDict(extra="forbid")

    replace: bool = False
    """A venue of this name may be replaced."""


def new_venue_routes(blackboard: Blackboard, configuration: Configuration) -> APIRouter:
    """Everything about the draft of a new venue."""
    router = APIRouter(prefix="/api/v1/new-venue", tags=["new venue"], responses=REFUSED)
    database = Path(blackboard.service.database)
    desk = Desk(database.parent / f"{database.stem}-draft")
    _draft_routes(router, desk)
    _picture_routes(router, desk, blackboard)
    _step_routes(router, desk, configuration)
    _end_routes(router, desk, configuration, blackboard.service)
    return router


def _draft_routes(router: APIRouter, desk: Desk) -> None:
    """The draft itself, and what there is to choose from."""

    @router.get("")
    def venue() -> NewVenueReport:
        """The draft, what its steps found, and how far the step is that runs."""
        return venue_from(desk)

    @router.patch("")
    def choose(patch: DraftPatch) -> NewVenueReport:
        """Changes choices: all of them, or none when one is not accepted."""
        draft = _patched(desk.draft, patch)
        desk.change(draft, ", ".join(_changed(desk.draft, draft)) or "the choices", patch.seen)
        return venue_from(desk)

    @router.delete("")
    def begin_anew() -> NewVenueReport:
        """Begins with an empty draft; undo brings the old one back."""
        desk.change(Draft(), "begin anew")
        return venue_from(desk)

    @router.post("/undo")
    def undo() -> NewVenueReport:
        """Takes the newest change of the draft back."""
        desk.undo()
        return venue_from(desk)

    @router.post("/redo")
    def redo() -> NewVenueReport:
        """Makes the change again that was taken back last."""
        desk.redo()
        return venue_from(desk)

    @router.get("/choices")
    def choices() -> ChoicesReport:
        """Field presets and marker patterns that come with PSLV."""
        return choices_from()

    @router.get("/patterns/{name}.svg", response_class=Response)
    def pattern(name: str, marker: int | None = None, team: Team = Team.BLUE) -> Response:
        """A marker of a pattern as a picture, its front up. marker: its id; without it the pattern's first."""
        pattern = pattern_choices().get(name)
        if pattern is None:
            raise HTTPException(404, "no such pattern")
        ids = pattern.code_by_id
        shown = next(iter(ids)) if marker is None else marker
        if shown not in ids:
            raise HTTPException(404, "no such id")
        return Response(marker_svg(pattern, team, shown), media_type="image/svg+xml")


def _picture_routes(router: APIRouter, desk: Desk, blackboard: Blackboard) -> None:
    """Pictures of the venue."""

    @router.post("/pictures", openapi_extra=FILE_BODY)
    async def add(request: Request, name: Annotated[str, Query(max_length=200)]) -> NewVenueReport:
        """Takes one picture's file, at most 32 MB, as application/octet-stream. A bad one is refused with its name,
        and the others stay."""
        data = await request.body()
        await asyncio.to_thread(desk.add_picture, name, data)
        return await asyncio.to_thread(venue_from, desk)

    @router.post("/pictures/camera")
    def take() -> NewVenueReport:
        """Takes the newest picture of the camera in use."""
        picture = blackboard.picture()
        if picture is None:
            raise HTTPException(503, "no image yet")
        desk.add_pixels(f"frame-{picture.number}.png", picture.pixels)
        source = blackboard.service.settings.source
        if source.device is not None and not desk.draft.source:
            desk.change(msgspec.structs.replace(desk.draft, source=source.uri), "the camera in use")
        return venue_from(desk)

    @router.delete("/pictures/{index}")
    def remove(index: int) -> NewVenueReport:
        """Takes a picture out."""
        picture = desk.picture(index)
        left = tuple(one for one in desk.draft.pictures if one != picture)
        desk.change(msgspec.structs.replace(desk.draft, pictures=left), f"without {picture.name}")
        return venue_from(desk)

    @router.get("/pictures/{index}.jpg", response_class=Response)
    def shown(index: int, small: bool = False) -> Response:
        """A picture as a browser shows it."""
        return Response(desk.shown(index, small=small), media_type="image/jpeg")

    @router.get("/pictures/{index}/overlay.png", response_class=Response)
    def overlay(index: int) -> Response:
        """What was seen in a picture with the venue, drawn over it."""
        return Response(desk.overlay(index), media_type="image/png")

    @router.get("/pictures/{index}/classes")
    def classes(index: int) -> ClassesReport:
        """The color classes of a picture's pixels: how much each has."""
        found = desk.classes(index)
        classes = [
            ClassReport(name=name, share=share, color=found.colors[name]) for name, share in found.shares.items()
        ]
        return ClassesReport(number=desk.drafts.number, classes=classes)

    @router.get("/pictures/{index}/classes.png", response_class=Response)
    def class_picture(index: int) -> Response:
        """The color class of every pixel of a picture."""
        return Response(desk.classes(index).pixels, media_type="image/png")


def _step_routes(router: APIRouter, desk: Desk, configuration: Configuration) -> None:
    """The steps that take long, and what they find taken over."""

    @router.post("/field", status_code=HTTPStatus.ACCEPTED)
    def recognize(wanted: RecognizeRequest) -> NewVenueReport:
        """Begins to search every field preset in the pictures; GET says how far it is."""
        desk.recognize(wanted.height_m)
        return venue_from(desk)

    @router.post("/field/accept")
    def accept_field(wanted: PresetRequest) -> NewVenueReport:
        """Takes a preset, with its camera where the search has found one."""
        desk.take_field(wanted.preset)
        return venue_from(desk)

    @router.post("/camera", status_code=HTTPStatus.ACCEPTED)
    def calibrate(wanted: CameraRequest) -> NewVenueReport:
        """Begins to search the camera; GET says how far it is."""
        corners = wanted.corners_px
        desk.calibrate(
            CameraWish(
                begin=wanted.begin,
                corners_px=(corners[0], corners[1], corners[2], corners[3]) if corners is not None else None,
                height_m=wanted.height_m,
                swaps_ends=wanted.swap_ends,
                frees_measures=wanted.measures,
            )
        )
        return venue_from(desk)

    @router.post("/camera/accept")
    def accept_camera() -> NewVenueReport:
        """Takes the camera that was found, and the measures that were solved with it."""
        desk.take_camera()
        return venue_from(desk)

    @router.post("/colors", status_code=HTTPStatus.ACCEPTED)
    def find_colors() -> NewVenueReport:
        """Begins to search the colors of markers and ball in the pictures, without a name for any of them."""
        desk.find_colors()
        return venue_from(desk)

    @router.post("/colors/accept")
    def accept_colors(wanted: ColorsRequest) -> NewVenueReport:
        """Takes the colors that were found, in place of all samples."""
        desk.take_colors(takes_doubtful=wanted.doubtful)
        return venue_from(desk)

    @router.post("/samples")
    def sample(wanted: SampleRequest) -> SampledReport:
        """Measures the color of a place in a picture, as the venue's light would show it, and adds it to a class."""
        found = desk.sample(wanted.picture, (wanted.x, wanted.y), wanted.radius, wanted.name)
        return SampledReport(color=found.color, words=found.words, venue=venue_from(desk))

    @router.delete("/samples")
    def remove_sample(name: str, color: str) -> NewVenueReport:
        """Takes a sample out."""
        desk.change(without_sample(desk.draft, name, color), f"without {color} of {name}")
        return venue_from(desk)

    @router.post("/trial", status_code=HTTPStatus.ACCEPTED)
    def try_it() -> NewVenueReport:
        """Begins to look for robots and balls in every picture, with the venue and with the settings in use."""
        desk.try_it(configuration.settings)
        return venue_from(desk)

    @router.delete("/job")
    def cancel() -> NewVenueReport:
        """Ends the step that runs; nothing is kept of it."""
        desk.job.cancel()
        return venue_from(desk)


def _end_routes(router: APIRouter, desk: Desk, configuration: Configuration, service: ServiceInfo) -> None:
    """The venue as a file, compared with what is in use, saved, used."""

    @router.get("/file", response_class=Response)
    def file() -> Response:
        """The venue's file as it would be saved."""
        name = f'attachment; filename="{desk.draft.name}.toml"'
        return Response(venue_text(desk.draft), media_type="application/toml", headers={"content-disposition": name})

    @router.get("/differences")
    def compare() -> list[DifferenceReport]:
        """What the venue changes of the settings in use."""
        with refused(HTTPStatus.CONFLICT):
            venue = settings_of(desk.draft)
        found = differences(venue, configuration.settings)
        return [DifferenceReport(key=key, before=old, after=new) for key, (old, new) in found.items()]

    @router.post("/save")
    def save(wanted: SaveRequest) -> SavedReport:
        """Writes the venue into the data folder."""
        with refused(HTTPStatus.CONFLICT, field="name"):
            path = save_venue(desk.draft, desk.drafts.pictures, replaces=wanted.replace)
        return SavedReport(path=str(path), command=f"pslv serve --venue {desk.draft.name}")

    @router.post("/use")
    def use(request: Request) -> ChangeReport:
        """Makes the saved venue of this name the settings, as one change that can be undone. It waits for a restart."""
        name = desk.draft.name
        path = own_venues_folder() / f"{name}.toml"
        if not path.exists():
            raise RequestRefused(HTTPStatus.CONFLICT, f"venue {name}", found="not saved", accepted="saved first")
        with refused(HTTPStatus.CONFLICT):
            layers = layers_of(str(path))
            venue = settings_from_layers(layers)
        if not any("source" in layer.table for layer in layers if layer.kind is LayerKind.VENUE):
            venue = msgspec.structs.replace(venue, source=configuration.settings.source)
        values, what = changes_to(venue, configuration), f"venue {name}"
        wanted = configuration.with_changes(values, what)
        if wanted.source.uri != configuration.settings.source.uri:
            sources.check_source(wanted, service)
        return change(configuration, values, request, what)


def _sent(patch: DraftPatch) -> dict[str, Any]:
    """The choices that a request contains."""
    return {
        key: value for key in patch.model_fields_set if key != "seen" and (value := getattr(patch, key)) is not None
    }


def _changed(old: Draft, new: Draft) -> list[str]:
    """The choices that differ between two drafts, in words, without what came with another one."""
    differ = {name for name in CHOICES if getattr(old, name) != getattr(new, name)}
    differ -= {"field"} if "preset" in differ else set()
    differ -= {"robot_radius_m", "robot_height_m"} if "pattern" in differ else set()
    short = differ - {"about", "field"}
    return [
        f"{words} {getattr(new, name)}" if name in short else words for name, words in CHOICES.items() if name in differ
    ]


def _patched(draft: Draft, patch: DraftPatch) -> Draft:
    """A draft with other choices; a camera for another field goes. Raises RequestRefused."""
    sent = _sent(patch)
    with refused(HTTPStatus.UNPROCESSABLE_ENTITY, field="preset" if "preset" in sent else "pattern"):
        draft = with_preset(draft, sent.pop("preset")) if "preset" in sent else draft
        draft = with_pattern(draft, sent.pop("pattern")) if "pattern" in sent else draft
    if (measures := sent.pop("field", None)) is not None:
        field = _field(measures)
        camera = draft.camera if field == draft.field else None
        draft = msgspec.structs.replace(draft, field=field, preset=draft.preset or OWN_FIELD, camera=camera)
    return msgspec.structs.replace(draft, **sent)


def _field(measures: FieldMeasures) -> FieldSettings:
    """Raises RequestRefused for measures that no field has."""
    try:
        return msgspec.convert(measures.model_dump(), FieldSettings)
    except msgspec.ValidationError as error:
        found, _, place = str(error).partition(" - at `$.")
        field = f"field.{place.rstrip('`')}" if place else "field"
        raise RequestRefused(
            HTTPStatus.UNPROCESSABLE_ENTITY, field, found=found, accepted="measures in metres", field=field
        ) from None
