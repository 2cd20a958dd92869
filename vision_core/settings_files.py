"""Loads settings: default.toml < field preset < venue < --config < options. The only loader.

Tables are merged key by key; lists and ``colors.classes`` (a palette is one thing) are replaced.
Every complaint names the file and the key, what was found and what would be accepted.
"""

import difflib
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from vision_core.camera_model import CameraModel, HomographyCamera, PinholeCamera
from vision_core.errors import SettingsError
from vision_core.mirror_model import Mirror, check_span
from vision_core.settings import ColorRange, Settings

Table = dict[str, Any]
REPLACED = frozenset({"colors.classes"})
SPACE_KEYS = {"hsv": {"hue_deg", "saturation", "value"}, "ymp": {"luma", "module", "phase_deg"}}
ANGLES = {"hue_deg", "phase_deg"}


@dataclass(frozen=True, slots=True)
class Layer:
    """One source of values, and what to call it in a complaint."""

    name: str
    table: Table


@cache
def config_folder() -> Path:
    """The shipped ``config`` folder: inside the wheel, or beside the package in a checkout."""
    package = Path(__file__).parent
    inside = package / "config"
    return inside if inside.is_dir() else package.parent / "config"


def load_settings(
    venue: str | None = None, config: Path | None = None, options: Mapping[str, Any] | None = None
) -> Settings:
    """Merge all layers and check them.

    venue: a name of config/venues or a path; config: a further file; options: dotted keys,
    ``{"server.port": 8001}``, of which None values are left out. Raises SettingsError.
    """
    upper = []
    if venue is not None:
        upper.append(read_layer(find_file("venues", venue)))
    if config is not None:
        upper.append(read_layer(config))
    upper.append(Layer("command line or environment", _nested(options or {})))
    lowest = read_layer(config_folder() / "default.toml")
    preset = lowest.table["field_preset"]
    for layer in upper:
        preset = layer.table.get("field_preset", preset)
    field = read_layer(find_file("fields", str(preset)))
    return settings_from_layers([lowest, field, *upper])


def settings_from_layers(layers: list[Layer]) -> Settings:
    """Merge layers, later wins, and check the result. Raises SettingsError naming the layer."""
    merged: Table = {}
    for layer in layers:
        merged = _merged(merged, layer.table)
    try:
        settings = msgspec.convert(merged, Settings)
    except msgspec.ValidationError as error:
        raise _explained(str(error), merged, layers) from None
    _check(settings, layers)
    return settings


def camera_model_from(settings: Settings) -> CameraModel:
    """The camera that the settings describe."""
    import numpy as np

    camera = settings.camera
    if camera.model == "pinhole":
        lens = camera.pinhole
        return PinholeCamera(lens.focal_px, lens.center_px, lens.distortion, lens.position_m, lens.rotation_deg)
    assert camera.homography is not None
    pixels = np.array([point.pixel_px for point in camera.homography.points])
    places = np.array([point.field_m for point in camera.homography.points])
    return HomographyCamera(pixels, places, camera.homography.position_m)


def mirror_from(settings: Settings) -> Mirror:
    """The default mirror of the settings."""
    return Mirror(settings.mirror.a, settings.mirror.b, settings.mirror.c)


def find_file(kind: str, name: str) -> Path:
    """A shipped file of config/<kind> by name, or any file by path. Raises SettingsError."""
    if name.endswith(".toml"):
        return Path(name)
    shipped = config_folder() / kind / f"{name}.toml"
    if shipped.is_file() and "/" not in name:
        return shipped
    names = sorted(path.stem for path in (config_folder() / kind).glob("*.toml"))
    raise SettingsError(
        f"{kind[:-1]} {name!r}",
        found="no such file",
        accepted=f"{', '.join(names)}, or a path that ends with .toml",
    )


def read_layer(path: Path) -> Layer:
    """One TOML file. Raises SettingsError when it cannot be read."""
    try:
        return Layer(str(path), tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise SettingsError(f"configuration file {path}", found=error.strerror or str(error)) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SettingsError(f"configuration file {path}", found=str(error), accepted="TOML") from None


def _nested(options: Mapping[str, Any]) -> Table:
    nested: Table = {}
    for key, value in options.items():
        if value is None:
            continue
        *parents, last = key.split(".")
        table = nested
        for parent in parents:
            table = table.setdefault(parent, {})
        table[last] = value
    return nested


def _merged(below: Table, above: Table, path: str = "") -> Table:
    result = dict(below)
    for key, value in above.items():
        here = f"{path}.{key}" if path else key
        old = result.get(key)
        if isinstance(old, dict) and isinstance(value, dict) and here not in REPLACED:
            result[key] = _merged(old, value, here)
        else:
            result[key] = value
    return result


def _lookup(table: Any, keys: list[str]) -> tuple[bool, Any]:
    for key in keys:
        if isinstance(table, dict) and key in table:
            table = table[key]
        elif isinstance(table, list) and key.isdigit() and int(key) < len(table):
            table = table[int(key)]
        else:
            return False, None
    return True, table


def _culprit(keys: list[str], layers: list[Layer]) -> str:
    """The uppermost layer that sets a key, or one of its parents."""
    for depth in range(len(keys), 0, -1):
        for layer in reversed(layers):
            if _lookup(layer.table, keys[:depth])[0]:
                return layer.name
    return layers[-1].name


def _explained(message: str, merged: Table, layers: list[Layer]) -> SettingsError:
    """msgspec's complaint, with the file, the key, the value and the nearest known keys."""
    text, _, where = message.partition(" - at ")
    keys = re.findall(r"[A-Za-z_][A-Za-z0-9_-]*|\d+", where)
    if unknown := re.search(r"unknown field `(.*)`", text):
        bad = unknown.group(1)
        known = _known_keys(keys)
        close = difflib.get_close_matches(bad, known, n=1)
        hint = f" (did you mean {close[0]}?)" if close else ""
        name = ".".join([*keys, bad])
        return SettingsError(
            f"{_culprit([*keys, bad], layers)}: {name}",
            found=f"no setting of this name{hint}",
            accepted=", ".join(known),
        )
    if missing := re.search(r"missing required field `(.*)`", text):
        keys = [*keys, missing.group(1)]
        return SettingsError(f"{_culprit(keys, layers)}: {'.'.join(keys)}", found="nothing", accepted="a value")
    there, value = _lookup(merged, keys)
    return SettingsError(
        f"{_culprit(keys, layers)}: {'.'.join(keys)}",
        found=repr(value) if there else "",
        accepted=text.removeprefix("Expected ").replace("`", ""),
    )


def _known_keys(keys: list[str]) -> list[str]:
    """Names that the struct at a path accepts."""
    schema, definitions = msgspec.json.schema(Settings), {}
    definitions = schema["$defs"]

    def resolved(node: Any) -> Any:
        for option in node.get("anyOf", [node]):
            if "$ref" in option:
                return definitions[option["$ref"].rsplit("/", 1)[1]]
        return node

    node = resolved(schema)
    for key in keys:
        if "properties" in node and key in node["properties"]:
            node = resolved(node["properties"][key])
        elif "items" in node:
            node = resolved(node["items"])
        elif "additionalProperties" in node:
            node = resolved(node["additionalProperties"])
    return sorted(node.get("properties", {}))


def _check(settings: Settings, layers: list[Layer]) -> None:
    """Rules that span several keys."""

    def refuse(key: str, found: str, accepted: str) -> SettingsError:
        return SettingsError(f"{_culprit(key.split('.'), layers)}: {key}", found=found, accepted=accepted)

    for name, boxes in settings.colors.classes.items():
        for box in boxes:
            _check_box(name, box, settings.colors.space, refuse)
    classes = list(settings.colors.classes)
    if len(classes) > 31:
        raise refuse("colors.classes", f"{len(classes)} classes", "at most 31")
    for key, wanted in [("ball.color", [settings.ball.color]), ("ball.surrounding", settings.ball.surrounding)]:
        for name in wanted:
            if name not in classes:
                raise refuse(key, repr(name), f"a color class: {', '.join(classes)}")
    for name in ("first_blue", "first_yellow"):
        if ord(getattr(settings.protocol.letters, name)) + 15 > ord("~"):
            raise refuse(f"protocol.letters.{name}", "fewer than 16 letters from there on", "A, a, ...")
    for key in ("blue_ids", "yellow_ids"):
        ids = getattr(settings.match, key)
        if len(ids) < settings.match.numbers or len(set(ids)) < len(ids):
            raise refuse(
                f"match.{key}", f"{list(ids)}", f"at least match.numbers ({settings.match.numbers}) ids, each once"
            )
    if settings.camera.model == "homography" and settings.camera.homography is None:
        raise refuse("camera.homography", "nothing", "four named points, as camera.model says homography")
    key = f"camera.{settings.camera.model}"
    try:
        camera = camera_model_from(settings)
    except SettingsError as error:
        raise refuse(key, error.found, error.accepted) from None
    if not camera.position_m[2] > settings.robots.height_m:
        raise refuse(f"{key}.position_m", f"{camera.position_m[2]:g} m", "a camera higher than the robots' markers")
    field = settings.field
    limit = 2.0 * (field.margin_m + field.goal.depth_m)
    diagonal = float((field.length_m + limit) ** 2 + (field.width_m + limit) ** 2) ** 0.5
    try:
        check_span(mirror_from(settings), diagonal)
    except SettingsError as error:
        raise refuse("mirror", error.found, error.accepted) from None


def _check_box(name: str, box: ColorRange, space: str, refuse: Any) -> None:
    given = {key: getattr(box, key) for key in box.__struct_fields__ if getattr(box, key) is not None}
    key = f"colors.classes.{name}"
    if foreign := sorted(given.keys() - SPACE_KEYS[space]):
        raise refuse(key, ", ".join(foreign), f"{', '.join(sorted(SPACE_KEYS[space]))} (colors.space is {space})")
    for axis, (low, high) in given.items():
        if axis not in ANGLES and low > high:
            raise refuse(f"{key}.{axis}", f"[{low:g}, {high:g}]", "the lower end first")
