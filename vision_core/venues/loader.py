"""Loads settings: default.toml < field preset < pattern < venue < --config < options. The only loader.

Tables are merged key by key; lists, ``colors.classes`` and ``colors.samples`` are replaced as a whole, since colors are
tuned against each other. A class that a file defines by samples replaces one of the same name by ranges in the files
below it, and the other way round. Every message names the file, line and key, what was found and what is accepted.

A name of another file (field, pattern, venue, pictures) is looked up in this order: a name that ends with ``.toml``,
and the path of ``file:PATH``, is a path relative to the file that it stands in (on the command line: to the working
folder); any other name is a shipped file of ``config/``.
"""

import difflib
import logging
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
from vision_core.user_files import read_text
from vision_core.venues.rules import check_settings
from vision_core.venues.toml_lines import line_of

Table = dict[str, Any]
KINDS = {"int": "a whole number", "float": "a number", "str": "a text", "object": "a table", "array": "a list"}
"""Types in msgspec's messages, in words."""
DICTS = {
    "colors.classes": tuple[ColorRange, ...],
    "colors.samples": tuple[HexColor, ...],
    "tasks": TaskSettings,
}
"""Settings whose keys are names of the user's choice, with the type of their values."""
REPLACED = frozenset({"colors.classes", "colors.samples"})
"""Tables that an upper layer replaces as a whole."""
RENAMED = {
    "robots.beyond_m": "robots.margin_m",
    "colors.light.beyond_m": "colors.light.margin_m",
    "blobs.strip": "blobs.scan_band",
    "blobs.most_flooded": "blobs.max_flood_fraction",
    "synthetic.feet": "synthetic.walking_people",
}
"""Former names of settings, which files may go on to use."""
FILE_NAMES = ("field_preset", "robots.pattern", "robots.blue.pattern", "robots.yellow.pattern")
"""Settings whose value may be a path of a .toml file."""
MAX_FILE_BYTES = 256 * 1024
"""Largest settings file: fifteen times default.toml."""
MAX_DEPTH = 16
"""Most tables within each other, and most parts of a dotted key."""
LONG_KEY = re.compile(rf"(?<![\w.\"'-])(?:[\w\"'-]++\s*+\.\s*+){{{MAX_DEPTH}}}")
"""A dotted key of more parts than that; tomllib's time grows with the square of their number."""

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Layer:
    """One source of values."""

    name: str
    """What messages call it: a path, or "command line or environment"."""
    table: Table
    text: str = ""
    """Content of the file; empty for a layer that is no file."""


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
    """The file and line that set a key, or the name of the layer that is no file."""
    return _place(key.split("."), layers)


def _place(keys: list[str], layers: list[Layer]) -> str:
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
    """Outline, size and height of the robots, as the files of their patterns give them."""
    layers = []
    for path, table in (((), robots), *(((team,), robots.get(team)) for team in ("blue", "yellow"))):
        if isinstance(table, dict) and isinstance(name := table.get("pattern"), str):
            pattern = read_layer(find_file("patterns", name))
            layers.append(Layer(pattern.name, _nested({".".join(("robots", *path)): pattern.table.get("robot", {})})))
    return layers


def settings_from_layers(layers: list[Layer], *, complete_palette: bool = True) -> Settings:
    """Merge layers, later wins, and check the result.

    complete_palette: the colors of the ball must have classes; False for commands that help to make a palette.
    Raises SettingsError naming file, line and key.
    """
    merged: Table = {}
    for layer in layers:
        merged = _with_one_palette(_merged(merged, layer.table), layer.table)
    for keys, number in _numbers(merged, []):
        if not math.isfinite(number):
            raise SettingsError(f"{_place(keys, layers)}: {'.'.join(keys)}", found=str(number), accepted="a number")
    try:
        settings = msgspec.convert(merged, Settings)
    except msgspec.ValidationError as error:
        raise _explained(str(error), merged, layers) from None
    check_settings(settings, lambda key: place_of(key, layers), complete_palette=complete_palette)
    return settings


def find_file(kind: str, name: str) -> Path:
    """A shipped file of config/<kind> by its name, or any file by a path that ends with .toml. Raises SettingsError."""
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
    """One TOML file, with keys by their present names and files by absolute paths. Raises SettingsError."""
    asked = f"configuration file {path}"
    text = read_text(path, asked, SettingsError, max_bytes=MAX_FILE_BYTES)
    if LONG_KEY.search(text):
        raise SettingsError(asked, found=f"a key of more than {MAX_DEPTH} parts", accepted="keys of this file's kind")
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # no TOML; brackets without end
        raise SettingsError(asked, found=str(error), accepted="TOML") from None
    if _depth(table) > MAX_DEPTH:
        raise SettingsError(asked, found=f"tables in more than {MAX_DEPTH} others", accepted="keys of this file's kind")
    layer = Layer(str(path), table, text)
    _rename(layer)
    _make_absolute(table, path.absolute().parent)
    return layer


def _rename(layer: Layer) -> None:
    """Give values of a layer that stand under a former key their present one, and log that."""
    for old, new in RENAMED.items():
        *parents, last = old.split(".")
        is_there, table = _lookup(layer.table, parents)
        if not is_there or not isinstance(table, dict) or last not in table:
            continue
        where = f"{layer.name}, line {line_of(layer.text, [*parents, last])}"
        present = new.rpartition(".")[2]
        if present in table:
            raise SettingsError(f"{where}: {old}", found=f"{new} as well, its present name", accepted="one of them")
        table[present] = table.pop(last)
        log.warning("%s is now called %s (%s)", old, new, where)


def _make_absolute(table: Table, folder: Path) -> None:
    """Make relative names of files absolute, from the folder of the file that they stand in."""
    for key in FILE_NAMES:
        *parents, last = key.split(".")
        _, parent = _lookup(table, parents)
        if isinstance(parent, dict) and isinstance(name := parent.get(last), str) and name.endswith(".toml"):
            parent[last] = str(folder / name)
    _, source = _lookup(table, ["source"])
    if isinstance(source, dict) and re.match("file:.", uri := str(source.get("uri", ""))):
        source["uri"] = f"file:{folder / uri.removeprefix('file:')}"


def _with_one_palette(merged: Table, above: Table) -> Table:
    """Merged tables in which no color class of the layer merged last has its old definition of the other kind too."""
    colors, new = merged.get("colors"), above.get("colors")
    if not isinstance(colors, dict) or not isinstance(new, dict):
        return merged
    colors = dict(colors)
    for kind, other in (("samples", "classes"), ("classes", "samples")):
        named, old = new.get(kind), colors.get(other)
        if isinstance(named, dict) and isinstance(old, dict) and other not in new:
            colors[other] = {name: value for name, value in old.items() if name not in named}
    return {**merged, "colors": colors}


def _depth(table: Any) -> int:
    """How many tables and lists lie within each other at most."""
    depth, level = 0, [table]
    while level:
        depth += 1
        inner = [list(node.values()) if isinstance(node, dict) else node for node in level]
        level = [item for items in inner for item in items if isinstance(item, (dict, list))]
    return depth


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
    """Is there a value at a path, and which?"""
    for key in keys:
        if isinstance(table, dict) and key in table:
            table = table[key]
        elif isinstance(table, list) and key.isdigit() and int(key) < len(table):
            table = table[int(key)]
        else:
            return False, None
    return True, table


def _culprit(keys: list[str], layers: list[Layer]) -> Layer:
    """The uppermost layer that sets a key, or else the nearest of its parents."""
    for depth in range(len(keys), 0, -1):
        for layer in reversed(layers):
            if _lookup(layer.table, keys[:depth])[0]:
                return layer
    return layers[-1]


def _explained(message: str, merged: Table, layers: list[Layer]) -> SettingsError:
    """msgspec's message as ours: with the file, the key, the value and the nearest known keys."""
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
            f"{_place([*keys, bad], layers)}: {name}",
            found=f"no setting of this name{hint}",
            accepted=", ".join(known),
        )
    if missing := re.search(r"missing required field `(.*)`", text):
        keys = [*keys, missing.group(1)]
        return SettingsError(f"{_place(keys, layers)}: {'.'.join(keys)}", found="nothing", accepted="a value")
    is_there, value = _lookup(merged, keys)
    return SettingsError(
        f"{_place(keys, layers)}: {'.'.join(keys)}",
        found=repr(value) if is_there else "",
        accepted=_accepted(text, keys),
    )


def _accepted(text: str, keys: list[str]) -> str:
    """The value that msgspec expected, in words."""
    if choices := _schema_node(keys).get("enum"):
        return ", ".join(choices)
    wanted = text.removeprefix("Expected ").partition(", got")[0].replace("`", "")
    for kind, words in KINDS.items():
        wanted = re.sub(rf"\b{kind}\b", words, wanted)
    return wanted


def _bad_entry(merged: Table, keys: list[str]) -> str:
    """Name of the first wrong entry of one of the dicts in the settings."""
    for name, entry in _lookup(merged, keys)[1].items():
        try:
            msgspec.convert(entry, DICTS[".".join(keys)])
        except msgspec.ValidationError:
            return str(name)
    return "?"


def _known_keys(keys: list[str]) -> list[str]:
    """Names of the keys of the struct at a path."""
    return sorted(_schema_node(keys).get("properties", {}))


def _schema_node(keys: list[str]) -> dict[str, Any]:
    """The node of the settings' JSON schema at a path."""
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
