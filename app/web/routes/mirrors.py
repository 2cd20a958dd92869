"""``/api/v1/mirrors``: A, B, C of equation 1 that robots see through: of the field, of a team, of one robot."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Path, Query, Request
from pydantic import ConfigDict

from app.web.configuration.configuration import Configuration
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.changes import ChangeReport
from app.web.reports.mirrors import (
    MirrorInForce,
    MirrorPreview,
    MirrorsReport,
    ViolationReport,
    entries_of,
    in_force,
    mirrors_from,
    preview_from,
)
from app.web.routes.change import change
from vision_core.errors import SettingsError
from vision_core.models.from_settings import FIELD, scope_of
from vision_core.models.mirror import Mirror, constants_fault
from vision_core.types.objects import Team
from vision_core.types.tables import MAX_NUMBERS

Number = Annotated[int, Path(ge=1, le=MAX_NUMBERS)]


class Constants(Report):
    """A, B, C of equation 1 for distances in millimetres."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    a: float
    b: float
    c: float


def mirror_routes(configuration: Configuration) -> APIRouter:
    """The mirrors in force, and changing them between two frames. A robot's goes before its team's, that before the
    field's; in practice mode a client may ask for one of its own, which goes before all."""
    router = APIRouter(prefix="/api/v1/mirrors", tags=["mirrors"])

    @router.get("")
    def mirrors() -> MirrorsReport:
        """All mirrors in force: of the field, of both teams, of every robot that may connect."""
        return mirrors_from(configuration)

    @router.post("/preview", responses=REFUSED)
    def preview(
        constants: Constants,
        color: Annotated[Team | None, Query()] = None,
        number: Annotated[int | None, Query(ge=1, le=MAX_NUMBERS)] = None,
    ) -> MirrorPreview:
        """What a mirror would be: its curve, its horizon, and every rule that it breaks. Nothing is changed.
        color, number: for a team or a robot; without them for the field."""
        if color is None and number is not None:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                f"robot {number}",
                found="no color",
                accepted="blue or yellow",
                field="color",
            )
        return _preview(configuration, constants, scope_of(color, number))

    @router.get(f"/{FIELD}")
    def field_mirror() -> MirrorInForce:
        """The mirror of the robots that have no other."""
        return in_force(configuration, None)

    @router.put(f"/{FIELD}", responses=REFUSED)
    def set_field_mirror(constants: Constants, request: Request) -> ChangeReport:
        """Gives the field's robots another mirror, at the next frame: no view is made with a mixture of both."""
        return _set(configuration, FIELD, constants, request)

    @router.delete(f"/{FIELD}", responses=REFUSED)
    def reset_field_mirror(request: Request) -> ChangeReport:
        """Gives the field's robots the mirror of the files again."""
        return _reset(configuration, FIELD, request)

    @router.get("/{color}", responses=REFUSED)
    def team_mirror(color: Team) -> MirrorInForce:
        """The mirror of a team's robots that have none of their own."""
        return in_force(configuration, color)

    @router.put("/{color}", responses=REFUSED)
    def set_team_mirror(color: Team, constants: Constants, request: Request) -> ChangeReport:
        """Gives the robots of a color another mirror, at the next frame. Refused in a match, unless all robots then
        see through the same one."""
        return _set(configuration, scope_of(color), constants, request)

    @router.delete("/{color}", responses=REFUSED)
    def reset_team_mirror(color: Team, request: Request) -> ChangeReport:
        """Gives the robots of a color the mirror of the files again."""
        return _reset(configuration, scope_of(color), request)

    @router.get("/{color}/{number}", responses=REFUSED)
    def robot_mirror(color: Team, number: Number) -> MirrorInForce:
        """The mirror of one robot."""
        return in_force(configuration, color, number)

    @router.put("/{color}/{number}", responses=REFUSED)
    def set_robot_mirror(color: Team, number: Number, constants: Constants, request: Request) -> ChangeReport:
        """Gives one robot another mirror, at the next frame. Refused in a match, as that of a team."""
        return _set(configuration, scope_of(color, number), constants, request)

    @router.delete("/{color}/{number}", responses=REFUSED)
    def reset_robot_mirror(color: Team, number: Number, request: Request) -> ChangeReport:
        """Gives one robot the mirror of the files again: its own there, or that of its team or the field."""
        return _reset(configuration, scope_of(color, number), request)

    return router


def _values(scope: str, constants: Constants) -> dict[str, object]:
    table = constants.model_dump()
    return {key: table[name] if name else table for name, key in entries_of(scope).items()}


def _set(configuration: Configuration, scope: str, constants: Constants, request: Request) -> ChangeReport:
    words = f"mirror of {scope}: {constants.a:g} {constants.b:g} {constants.c:g}"
    return change(configuration, _values(scope, constants), request, words)


def _reset(configuration: Configuration, scope: str, request: Request) -> ChangeReport:
    values = dict.fromkeys(entries_of(scope).values())
    return change(configuration, values, request, f"mirror of {scope}: as in the files")


def _preview(configuration: Configuration, constants: Constants, scope: str) -> MirrorPreview:
    a, b, c = constants.a, constants.b, constants.c
    fault = constants_fault(a, b, c)
    mirror, violations = None, []
    try:
        mirror = Mirror(a, b, c)
        configuration.with_changes(_values(scope, constants), f"mirror of {scope}")
    except SettingsError as error:
        violations.append(
            ViolationReport(constant=fault[0] if fault else "", found=error.found, accepted=error.accepted)
        )
    except RequestRefused as refusal:
        found, accepted = refusal.parts["found"], refusal.parts["accepted"]
        violations.append(ViolationReport(constant="", found=found, accepted=accepted))
    return preview_from(scope, mirror, violations, configuration.settings)
