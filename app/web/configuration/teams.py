"""What a registered team is."""

import re
import unicodedata
from typing import Annotated

from pydantic import ConfigDict, Field, StringConstraints

from app.web.reports.base import Report

MAX_ROBOTS = 16
Name = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=40)]
ShortName = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=12)]
Contact = Annotated[str, StringConstraints(strip_whitespace=True, max_length=120)]
MarkerId = Annotated[int, Field(ge=0, le=255)]


class TeamEntry(Report):
    """A team as it registers."""

    model_config = ConfigDict(strict=True, extra="forbid")

    name: Name
    short_name: ShortName
    """For small places: "CGN"."""
    contact: Contact = ""
    """Whom to call when its robots or programs disturb."""
    robots: list[MarkerId] = Field(default=[], max_length=MAX_ROBOTS)
    """Marker ids of its robots number 1, 2, ...; empty: as the settings have them for the color that it plays."""


def slug_of(short_name: str) -> str:
    """A team's name in addresses: "1. FC Köln" is "1-fc-koln". Empty when it has no Latin letter and no digit."""
    ascii_name = unicodedata.normalize("NFKD", short_name).encode("ascii", "ignore").decode()
    return re.sub(r"[^a-z0-9]+", "-", ascii_name.lower()).strip("-")
