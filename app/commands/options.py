"""Options that several commands have."""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vision_core.errors import SettingsError

if TYPE_CHECKING:
    from vision_core.types.objects import Team

Venue = Annotated[
    str | None, typer.Option(envvar="PSLV_VENUE", help="A venue: a name of config/venues, or a .toml file.")
]
ConfigFile = Annotated[
    Path | None, typer.Option("--config", envvar="PSLV_CONFIG", help="A further file of settings, over the venue.")
]


def scope_from(text: str) -> "tuple[Team | None, int | None]":
    """Whose mirror, from --for field, --for blue or --for blue:3. Raises SettingsError."""
    from vision_core.models.from_settings import FIELD
    from vision_core.types.objects import Team
    from vision_core.types.tables import MAX_NUMBERS

    team, colon, number = text.partition(":")
    if text == FIELD:
        return None, None
    if team not in list(Team) or (colon and not (number.isdecimal() and 1 <= int(number) <= MAX_NUMBERS)):
        accepted = f"{FIELD}, blue, yellow, or a robot's team and number, blue:1 to yellow:{MAX_NUMBERS}"
        raise SettingsError("--for", found=text or "nothing", accepted=accepted)
    return Team(team), int(number) if colon else None


def robot_of(text: str) -> tuple["Team", int]:
    """Team and number from --robot blue:1. Raises SettingsError."""
    team = number = None
    with contextlib.suppress(SettingsError):
        team, number = scope_from(text)
    if team is None or number is None:
        raise SettingsError("--robot", found=text, accepted="team and number: blue:1")
    return team, number
