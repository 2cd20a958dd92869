"""A venue that was set up becomes the settings: as one change of the page's, which can be undone."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from msgspec import to_builtins

from app.web.configuration.configuration import Configuration, flat
from app.web.configuration.keys import SETTING, setting
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import HomographySettings, NamedPoint, Settings

TABLES = ("field_preset", "source.", "field.", "mirror.", "camera.", "colors.", "robots.", "ball.", "match.numbers")
"""Settings that a venue is: the others stay as they are."""
TEAMS = ("robots.blue", "robots.yellow")
QUARTERS = ((0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75))


def changes_to(venue: Settings, configuration: Configuration) -> dict[str, Any]:
    """The changes of the page's entries after which the settings are those of a venue; None: as the files have it."""
    wanted, files = _own(venue), _own(configuration.base)
    wanted = _without_gaps(wanted, files, venue)
    values = {key: None if files.get(key) == value else value for key, value in wanted.items()}
    kept = {key.removeprefix(SETTING) for key in configuration.entries if key.startswith(SETTING)}
    return {setting(key): value for key, value in values.items() if value is not None or key in kept} | {
        setting(key): None for key in kept if key.startswith(TABLES) and key not in values
    }


def differences(venue: Settings, before: Settings) -> dict[str, tuple[Any, Any]]:
    """What a venue changes of the settings: before and after, by dotted keys."""
    old, new = _own(before), _own(venue)
    return {
        key: (old.get(key), new.get(key)) for key in sorted(old.keys() | new.keys()) if old.get(key) != new.get(key)
    }


def _own(settings: Settings) -> dict[str, Any]:
    """The settings of TABLES by dotted keys."""
    return {key: value for key, value in flat(to_builtins(settings)).items() if key.startswith(TABLES)}


def _without_gaps(wanted: Mapping[str, Any], files: Mapping[str, Any], venue: Settings) -> dict[str, Any]:
    """With a value for what the files have and the venue has not: a change cannot take away what a file has."""
    filled = dict(wanted)
    if files.get("camera.homography") and not wanted.get("camera.homography"):
        filled["camera.homography"] = to_builtins(_as_points(venue))
    for team in TEAMS:
        own = {key for key in files if key.startswith(f"{team}.")}
        for key in own - wanted.keys():
            filled.pop(team, None)
            filled[key] = wanted[f"robots.{key.removeprefix(f'{team}.')}"]
    return filled


def _as_points(venue: Settings) -> HomographySettings:
    """The venue's camera as four points of the floor."""
    camera = CameraSetup.from_settings(venue)
    pixels = np.array(QUARTERS) * camera.size_px
    places = camera.model.field_from_pixel(pixels)
    x, y, z = camera.model.position_m.tolist()
    points = tuple(
        NamedPoint(name=f"point {number}", pixel_px=tuple(pixel), field_m=tuple(place))
        for number, (pixel, place) in enumerate(zip(pixels.tolist(), places.tolist(), strict=True), start=1)
    )
    return HomographySettings(points=points, position_m=(x, y, z))
