"""``/api/v1/match``: who plays which color, sides, mode and play mode."""

from http import HTTPStatus
from typing import Literal

from fastapi import APIRouter, Request
from msgspec import to_builtins
from pydantic import ConfigDict, Field

from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import TEAM, plays, setting
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from app.web.reports.changes import ChangeReport
from app.web.routes.change import change
from vision_core.types.objects import Team

OTHER_SIDE = {"left": "right", "right": "left"}


class MatchReport(Report):
    """Who plays, on which side, and how."""

    revision: int
    blue: str | None
    """Registered team that plays blue; null: none."""
    yellow: str | None
    blue_name: str
    """Name of the team that plays blue; empty: none is known."""
    yellow_name: str
    blue_defends: Literal["left", "right"]
    """left: the goal at negative x."""
    mode: Literal["practice", "match"]
    """match: viewers see the field late, and clients cannot choose their options."""
    play_mode: str
    """Told to clients in the answer to init."""
    viewer_delay_s: float
    """How late viewers see the field while a match is played [s]."""
    open_practice: bool
    """Every address of a local network may connect as any robot: set, and no match is played."""


class MatchPatch(Report):
    """Changes of the match; keys that are not sent stay."""

    model_config = ConfigDict(extra="forbid")

    revision: int | None = None
    blue: str | None = None
    yellow: str | None = None
    blue_defends: Literal["left", "right"] | None = None
    mode: Literal["practice", "match"] | None = None
    play_mode: str | None = None
    viewer_delay_s: float | None = Field(default=None, ge=0.0, le=60.0)


class Swap(Report):
    """A swap; revision: the newest that was seen, null: whatever was changed since."""

    model_config = ConfigDict(extra="forbid")

    revision: int | None = None


def match_routes(configuration: Configuration) -> APIRouter:
    """The match."""
    router = APIRouter(prefix="/api/v1", tags=["match"])

    @router.get("/match")
    def match() -> MatchReport:
        """Who plays, on which side, and how."""
        return match_from(configuration)

    @router.patch("/match", responses=REFUSED)
    def change_match(patch: MatchPatch, request: Request) -> ChangeReport:
        """Changes who plays, the sides, the mode or the play mode, at the next frame."""
        sent = patch.model_dump(include=patch.model_fields_set - {"revision"})
        teams = {color: sent.pop(color.value) for color in Team if color.value in sent}
        _check_teams(configuration, teams)
        values = {setting(f"match.{key}"): value for key, value in sent.items()}
        values |= {plays(color): slug for color, slug in teams.items()}
        words = [
            f"{key} {value}" for key, value in {**sent, **{c.value: s or "nobody" for c, s in teams.items()}}.items()
        ]
        return change(configuration, values, request, f"match: {', '.join(words)}", patch.revision)

    @router.post("/match/swap_sides", responses=REFUSED)
    def swap_sides(swap: Swap, request: Request) -> ChangeReport:
        """Lets both teams defend the other goal, at the next frame; no session ends."""
        side = OTHER_SIDE[configuration.settings.match.blue_defends]
        return change(configuration, {setting("match.blue_defends"): side}, request, "swap sides", swap.revision)

    @router.post("/match/swap_colors", responses=REFUSED)
    def swap_colors(swap: Swap, request: Request) -> ChangeReport:
        """Lets the teams on the field play each other's color; their programs connect again by the new color."""
        entries = configuration.entries
        blue, yellow = entries.get(plays(Team.BLUE)), entries.get(plays(Team.YELLOW))
        if blue is None and yellow is None:
            raise RequestRefused(
                HTTPStatus.CONFLICT, "swap colors", found="no team on the field", accepted="a team for a color first"
            )
        return change(
            configuration, {plays(Team.BLUE): yellow, plays(Team.YELLOW): blue}, request, "swap colors", swap.revision
        )

    return router


def match_from(configuration: Configuration) -> MatchReport:
    """The match as it is now."""
    match, entries = to_builtins(configuration.settings.match), configuration.entries
    return MatchReport(
        revision=configuration.revision,
        blue=entries.get(plays(Team.BLUE)),
        yellow=entries.get(plays(Team.YELLOW)),
        open_practice=configuration.settings.admission.open_practice and match["mode"] == "practice",
        **{key: match[key] for key in MatchReport.model_fields if key in match},
    )


def _check_teams(configuration: Configuration, teams: dict[Team, str | None]) -> None:
    """Raises RequestRefused for a team that is not registered, or that would play against itself."""
    entries = configuration.entries
    for color, slug in teams.items():
        if slug is not None and f"{TEAM}{slug}" not in entries:
            names = [key.removeprefix(TEAM) for key in entries if key.startswith(TEAM)]
            accepted = ", ".join(names) or "a team must be registered first"
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                f"team for {color.value}",
                found=slug[:80],
                accepted=accepted,
                field=color.value,
            )
    both = [teams.get(color, entries.get(plays(color))) for color in Team]
    if both[0] is not None and both[0] == both[1]:
        raise RequestRefused(
            HTTPStatus.CONFLICT, "the teams on the field", found=f"{both[0]} twice", accepted="two teams"
        )
