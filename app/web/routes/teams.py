"""``/api/v1/teams``: the registered teams."""

from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request

from app.web.auth.team_keys import TeamKeys
from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import TEAM, plays
from app.web.configuration.teams import TeamEntry, slug_of
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.changes import ChangeReport
from app.web.routes.change import change
from vision_core.types.objects import Team


class TeamReport(TeamEntry):
    """A registered team."""

    slug: str
    """Its name in addresses."""
    plays: Team | None
    """The color that it plays; null: it is not on the field."""
    has_key: bool
    """It can open its own page with a key."""


class TeamRequest(TeamEntry):
    """A team as it is registered or changed."""

    revision: int | None = None
    """Newest revision that was seen; null: whatever was changed since is replaced."""


class NewKey(Report):
    """A key; it is told only once."""

    key: str


def team_routes(configuration: Configuration, keys: TeamKeys) -> APIRouter:
    """Registering teams."""
    router = APIRouter(prefix="/api/v1/teams", tags=["teams"])

    @router.get("")
    def teams() -> list[TeamReport]:
        """Every registered team."""
        entries = configuration.entries
        return [_report(key.removeprefix(TEAM)) for key in entries if key.startswith(TEAM)]

    @router.post("", responses=REFUSED, status_code=HTTPStatus.CREATED)
    def register(team: TeamRequest, request: Request) -> TeamReport:
        """Registers a team."""
        slug = slug_of(team.short_name) or slug_of(team.name)
        if not slug:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                "a team",
                found=team.short_name,
                accepted="a short name with a Latin letter or a digit",
                field="short_name",
            )
        if f"{TEAM}{slug}" in configuration.entries:
            raise RequestRefused(
                HTTPStatus.CONFLICT,
                f"team {team.short_name}",
                found="a team of this short name",
                accepted="another short name",
                field="short_name",
            )
        _put(slug, team, request, f"register team {team.name}")
        return _report(slug)

    @router.put("/{slug}", responses=REFUSED)
    def change_team(slug: str, team: TeamRequest, request: Request) -> TeamReport:
        """Changes a team; while it plays, its robots' markers take effect at the next frame."""
        _known(slug)
        _put(slug, team, request, f"change team {team.name}")
        return _report(slug)

    @router.delete("/{slug}", responses=REFUSED)
    def delete(slug: str, request: Request) -> ChangeReport:
        """Deletes a team and its key."""
        name = _known(slug)["name"]
        gone = {f"{TEAM}{slug}": None}
        gone |= {plays(color): None for color in Team if configuration.entries.get(plays(color)) == slug}
        made = change(configuration, gone, request, f"delete team {name}")
        keys.forget(slug)
        return made

    @router.post("/{slug}/key", responses=REFUSED)
    def new_key(slug: str) -> NewKey:
        """Makes a new key for a team; its former key is no longer accepted."""
        _known(slug)
        key = keys.renew(slug)
        configuration.publish()  # clients that came with the former key lose their robots
        return NewKey(key=key)

    def _known(slug: str) -> dict[str, Any]:
        team: dict[str, Any] | None = configuration.entries.get(f"{TEAM}{slug}")
        if team is None:
            names = [key.removeprefix(TEAM) for key in configuration.entries if key.startswith(TEAM)]
            raise RequestRefused(
                HTTPStatus.NOT_FOUND,
                "a team",
                found=slug[:80],
                accepted=", ".join(names) or "a team must be registered",
            )
        return team

    def _put(slug: str, team: TeamRequest, request: Request, what: str) -> None:
        value = team.model_dump(exclude={"revision"})
        change(configuration, {f"{TEAM}{slug}": value}, request, what, team.revision)

    def _report(slug: str) -> TeamReport:
        entries = configuration.entries
        color = next((color for color in Team if entries.get(plays(color)) == slug), None)
        return TeamReport(slug=slug, plays=color, has_key=keys.digest_of(slug) is not None, **_known(slug))

    return router
