"""Loads settings: default.toml < field preset < venue < --config < options. The only loader.

Tables are merged key by key; lists, ``colors.classes`` and ``colors.samples`` (a palette is one thing) are replaced.
Every complaint names the file and the key, what was found and what would be accepted.
"""

import difflib
import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from vision_core.errors import SettingsError
from vision_core.settings.schema import ColorRange, HexColor, Settings, TaskSettings
from vision_core.venues.rules import check_settings
from vision_core.venues.toml_lines import line_of

Table = dict[str, Any]
KINDS = {"int": "a whole number", "float": "a number", "str": "a text", "object": "a table", "array": "a list"}
DICTS = {
    "colors.classes": tuple[ColorRange, ...],
    "colors.samples": tuple[HexColor, ...],
    "tasks": TaskSettings,
}
"""Settings that are called as one likes, and what each is."""
REPLACED = frozenset({"colors.classes", "colors.samples"})


@dataclass(frozen=True, slots=True)
class Layer:
    """One source of values, and what to call it in a complaint."""

    name: str
    table: Table
    text: str = ""
    """Of the file."""


@cache
def config_folder() -> Path:
    """The shipped ``config`` folder: inside the wheel, or beside the package in a checkout."""
    package = Path(__file__).parents[1]
    inside = package / "config"
    return inside if inside.is_dir() else package.parent / "config"


def load_settings(
    venue: str | None = None, config: Path | None = None, options: Mapping[str, Any] | None = None
) -> Settings:
    """Merge all layers and check them.

    venue: a name of config/venues or a path; config: a further file; options: dotted keys,
    ``{"server.port": 8001}``, of which None values are left out. Raises SettingsError.
    """
    return settings_from_layers(layers_of(venue, config, options))


def place_of(key: str, layers: list[Layer]) -> str:
    """Where a setting stands: the file and its line, or what else set it."""
    keys = key.split(".")
    layer = _culprit(keys, layers)
    line = line_of(layer.text, keys)
    return layer.name if line is None else f"{layer.name}, line {line}"


def layers_of(
    venue: str | None = None, config: Path | None = None, options: Mapping[str, Any] | None = None
) -> list[Layer]:
    """All sources of values, the lowest first; as ``load_settings``. Raises SettingsError when one cannot be read."""
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
    robots = {key: value for layer in (lowest, *upper) for key, value in _robots(layer).items()}
    return [lowest, field, *_pattern_layers(robots), *upper]


def _robots(layer: Layer) -> Table:
    robots = layer.table.get("robots")
    return robots if isinstance(robots, dict) else {}


def _pattern_layers(robots: Table) -> list[Layer]:
    """What the files of the chosen patterns say about the robots that wear them: outline, size and height."""
    layers = []
    for path, table in (((), robots), *(((team,), robots.get(team)) for team in ("blue", "yellow"))):
        if isinstance(table, dict) and isinstance(name := table.get("pattern"), str):
            pattern = read_layer(find_file("patterns", name))
            layers.append(Layer(pattern.name, _nested({".".join(("robots", *path)): pattern.table.get("robot", {})})))
    return layers


def settings_from_layers(layers: list[Layer]) -> Settings:
    """Merge layers, later wins, and check the result. Raises SettingsError naming the layer."""
    merged: Table = {}
    for layer in layers:
        merged = _merged(merged, layer.table)
    for keys, number in _numbers(merged, []):
        if not math.isfinite(number):
            where = f"{_culprit(keys, layers).name}: {'.'.join(keys)}"
            raise SettingsError(where, found=str(number), accepted="a number")
    try:
        settings = msgspec.convert(merged, Settings)
    except msgspec.ValidationError as error:
        raise _explained(str(error), merged, layers) from None
    check_settings(settings, lambda key: _culprit(key.split("."), layers).name)
    return settings


def find_file(kind: str, name: str) -> Path:
    """A shipped file of config/<kind> by name, or any file by path. Raises SettingsError."""
    if name.endswith(".toml"):
        return Path(name)
    shipped = {path.stem: path for path in sorted((config_folder() / kind).glob("*.toml"))}
    if name in shipped:
        return shipped[name]
    raise SettingsError(
        f"{kind[:-1]} {name!r}",
        found="no such file",
        accepted=f"{', '.join(shipped)}, or a path that ends with .toml",
    )


def read_layer(path: Path) -> Layer:
    """One TOML file. Raises SettingsError when it cannot be read."""
    try:
        text = path.read_text(encoding="utf-8")
        return Layer(str(path), tomllib.loads(text), text)
    except OSError as error:
        raise SettingsError(f"configuration file {path}", found=error.strerror or str(error)) from None
    except (ValueError, RecursionError) as error:  # no TOML, no UTF-8, NUL in the name; brackets without end
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


def _numbers(node: Any, keys: list[str]) -> Iterator[tuple[list[str], float]]:
    """Every float of a table, with its keys."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from _numbers(value, [*keys, key])
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _numbers(value, [*keys, str(index)])
    elif isinstance(node, float):
        yield keys, node


def _lookup(table: Any, keys: list[str]) -> tuple[bool, Any]:
    for key in keys:
        if isinstance(table, dict) and key in table:
            table = table[key]
        elif isinstance(table, list) and key.isdigit() and int(key) < len(table):
            table = table[int(key)]
        else:
            return False, None
    return True, table


def _culprit(keys: list[str], layers: list[Layer]) -> Layer:
    """The uppermost layer that sets a key, or one of its parents."""
    for depth in range(len(keys), 0, -1):
        for layer in reversed(layers):
            if _lookup(layer.table, keys[:depth])[0]:
                return layer
    return layers[-1]


def _explained(message: str, merged: Table, layers: list[Layer]) -> SettingsError:
    """msgspec's complaint, with the file, the key, the value and the nearest known keys."""
    text, _, where = message.partition(" - at ")
    keys = re.findall(r"[A-Za-z_][A-Za-z0-9_-]*|\d+|\.\.\.", where)
    if "..." in keys:  # msgspec does not name the key of a dict: find the entry that fails by itself
        keys[keys.index("...")] = _bad_entry(merged, keys[: keys.index("...")])
    if unknown := re.search(r"unknown field `(.*)`", text):
        bad = unknown.group(1)
        known = _known_keys(keys)
        close = difflib.get_close_matches(bad, known, n=1)
        hint = f" (did you mean {close[0]}?)" if close else ""
        name = ".".join([*keys, bad])
        return SettingsError(
            f"{_culprit([*keys, bad], layers).name}: {name}",
            found=f"no setting of this name{hint}",
            accepted=", ".join(known),
        )
    if missing := re.search(r"missing required field `(.*)`", text):
        keys = [*keys, missing.group(1)]
        return SettingsError(f"{_culprit(keys, layers).name}: {'.'.join(keys)}", found="nothing", accepted="a value")
    there, value = _lookup(merged, keys)
    return SettingsError(
        f"{_culprit(keys, layers).name}: {'.'.join(keys)}",
        found=repr(value) if there else "",
        accepted=_accepted(text, keys),
    )


def _accepted(text: str, keys: list[str]) -> str:
    """What msgspec expected, in words for people."""
    if choices := _schema_node(keys).get("enum"):
        return ", ".join(choices)
    wanted = text.removeprefix("Expected ").partition(", got")[0].replace("`", "")
    for kind, words in KINDS.items():
        wanted = re.sub(rf"\b{kind}\b", words, wanted)
    return wanted


def _bad_entry(merged: Table, keys: list[str]) -> str:
    """The first entry that is wrong of one of the dicts in the settings."""
    for name, entry in _lookup(merged, keys)[1].items():
        try:
            msgspec.convert(entry, DICTS[".".join(keys)])
        except msgspec.ValidationError:
            return str(name)
    return "?"


def _known_keys(keys: list[str]) -> list[str]:
    """Names that the struct at a path accepts."""
    return sorted(_schema_node(keys).get("properties", {}))


def _schema_node(keys: list[str]) -> dict[str, Any]:
    """What the JSON schema of the settings says about a path."""
    schema = msgspec.json.schema(Settings)
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
    return dict(node)
