"""Reads a palette from a TOML or JSON file (docs/onboard.md)."""

import json
import math
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from vision_core.client.recognition.palette import DRAWN, RENDERED, Palette, Surface
from vision_core.errors import SettingsError
from vision_core.types.edges import Rgb
from vision_core.user_files import read_text

MAX_BYTES = 100_000
PRESETS: Mapping[str, Palette] = {"rendered": RENDERED, "drawn": DRAWN}
SURFACES = {surface.name.lower(): surface for surface in Surface if surface is not Surface.OTHER}
KEYS = ("tolerance", "dark_feet", "colors")


def load_palette(name: str) -> Palette:
    """The palette "rendered" or "drawn", or that of a file ending in .toml or .json.

    Raises SettingsError that names the file and the key.
    """
    if name in PRESETS:
        return PRESETS[name]
    path = Path(name)
    parsers: dict[str, Callable[[str], Any]] = {".toml": tomllib.loads, ".json": json.loads}
    if path.suffix.lower() not in parsers:
        accepted = f"{', '.join(PRESETS)}, or a file ending in {' or '.join(parsers)}"
        raise SettingsError("the palette", found=name, accepted=accepted)
    text = read_text(path, f"palette {path}", SettingsError, max_bytes=MAX_BYTES)
    try:
        table = parsers[path.suffix.lower()](text)
    except (ValueError, RecursionError) as error:
        raise SettingsError(f"palette {path}", found=str(error), accepted="valid TOML or JSON") from None
    return _palette_of(f"palette {path}", table)


def _palette_of(name: str, table: Any) -> Palette:
    if not isinstance(table, dict) or not set(table) <= set(KEYS):
        found = ", ".join(set(map(str, table)) - set(KEYS)) if isinstance(table, dict) else type(table).__name__
        raise SettingsError(f"{name}: keys", found=found, accepted=", ".join(KEYS))
    tolerance, dark_feet = table.get("tolerance", RENDERED.tolerance), table.get("dark_feet", False)
    if not isinstance(tolerance, int | float) or isinstance(tolerance, bool) or not 0.0 < tolerance <= 10.0:
        raise SettingsError(f"{name}: tolerance", found=repr(tolerance), accepted="a number above 0, at most 10")
    if not isinstance(dark_feet, bool):
        raise SettingsError(f"{name}: dark_feet", found=repr(dark_feet), accepted="true or false")
    colors = table.get("colors", {})
    if not isinstance(colors, dict) or not set(colors) <= set(SURFACES) or not {"floor"} < set(colors):
        found = ", ".join(colors) if isinstance(colors, dict) else repr(colors)
        accepted = f"floor, and at least one of {', '.join(SURFACES)}"
        raise SettingsError(f"{name}: colors", found=found or "none", accepted=accepted)
    references = [
        (SURFACES[key], rgb) for key, value in colors.items() for rgb in _colors_of(f"{name}: colors.{key}", value)
    ]
    return Palette(tuple(references), float(tolerance), dark_feet)


def _colors_of(name: str, value: Any) -> list[Rgb]:
    """The references of one surface: [red, green, blue], or several of them."""
    many = [value] if isinstance(value, list) and value and not isinstance(value[0], list) else value
    if not isinstance(many, list) or not many or not all(map(_is_rgb, many)):
        raise SettingsError(
            name, found=repr(value), accepted="[red, green, blue] with 0..255, or a list of such colors"
        )
    return [(round(red), round(green), round(blue)) for red, green, blue in many]


def _is_rgb(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 3
        and all(type(part) in (int, float) and math.isfinite(part) and 0 <= part <= 255 for part in value)
    )
