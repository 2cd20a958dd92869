"""From the document's entries to one layer of settings."""

from collections.abc import Mapping
from typing import Any

from msgspec import to_builtins

from app.web.configuration.keys import ADMISSION, REFUSAL, SETTING, TEAM, plays
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team


def overlay_from(entries: Mapping[str, Any], base: Settings, now_s: float) -> dict[str, Any]:
    """Values by dotted keys of the settings, for the layer above the user's files.

    base: the settings of the files alone, since lists of a layer replace those below it. now_s: the time of day
    [seconds since 1970]; admissions that have ended are left out.
    """
    overlay = {key.removeprefix(SETTING): value for key, value in entries.items() if key.startswith(SETTING)}
    for color in Team:
        overlay |= _team(entries, color)
    rules = [
        {name: value for name, value in entry.items() if name in ("network", "team", "number")}
        for key, entry in entries.items()
        if key.startswith(ADMISSION) and not has_ended(entry, now_s)
    ]
    refused = [key.removeprefix(REFUSAL) for key in entries if key.startswith(REFUSAL)]
    for setting, added in (("rules", rules), ("refused", refused)):
        if added:
            below = overlay.get(f"admission.{setting}", to_builtins(getattr(base.admission, setting)))
            overlay[f"admission.{setting}"] = [*below, *added]
    return overlay


def has_ended(admission: Mapping[str, Any], now_s: float) -> bool:
    """Is the time over for which an address was admitted?"""
    return admission["until"] is not None and admission["until"] <= now_s


def _team(entries: Mapping[str, Any], color: Team) -> dict[str, Any]:
    """The settings that follow from the team that plays a color."""
    team = entries.get(f"{TEAM}{entries.get(plays(color))}")
    if team is None:
        return {}
    robots = {f"match.{color.value}_ids": team["robots"]} if team["robots"] else {}
    return {f"match.{color.value}_name": team["name"]} | robots
