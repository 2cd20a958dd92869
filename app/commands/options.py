"""Options that several commands have."""

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


def robot_of(text: str) -> tuple["Team", int]:
    """Team and number from --robot blue:1. Raises SettingsError."""
    from vision_core.types.objects import Team

    team, _, number = text.partition(":")
    if team not in list(Team) or not number.isdecimal():
        raise SettingsError("--robot", found=text, accepted="team and number: blue:1")
    return Team(team), int(number)
