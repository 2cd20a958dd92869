"""Loads settings: default.toml < field preset < pattern < venue < --config < page < options. The only loader.

``layers_of`` reads the files; ``with_overlay`` puts what was changed on the page over layers that were read before.
``settings_from_layers`` merges and checks either.

Tables are merged key by key; lists, ``colors.classes`` and ``colors.samples`` are replaced as a whole, since colors are
tuned against each other. A class that a file defines by samples replaces one of the same name by ranges in the files
below it, and the other way round. Every message names the file, line and key, what was found and what is accepted.

A name of another file (field, pattern, venue, pictures) is looked up in this order: a name that ends with ``.toml``,
and the path of ``file:PATH``, is a path relative to the file that it stands in (on the command line: to the working
folder); any other name is a shipped file of ``config/`` or, of a venue, one of the data folder's ``venues``.
"""

import logging
import math
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from vision_core.errors import SettingsError
from vision_core.native.kernel_folder import data_folder
from vision_core.settings.layers import Layer, LayerKind, Table
from vision_core.settings.schema import Settings
from vision_core.user_files import read_text
from vision_core.venues.explanation import explained
from vision_core.venues.rules import check_settings
from vision_core.venues.tables import (
    MAX_DEPTH,
    depth,
    lookup,
    merged,
    nested,
    numbers,
    place,
    place_of,
    with_one_palette,
    with_own_light,
)
from vision_core.venues.toml_lines import line_of

__all__ = [
    "PAGE",
    "Layer",
    "config_folder",
    "find_file",
    "layers_of",
    "layers_of_text",
    "load_settings",
    "own_venues_folder",
    "place_of",
    "read_layer",
    "settings_from_layers",
    "with_overlay",
]

PAGE = "changes made on the page"
"""What messages call that layer."""
OPTIONS = "command line or environment"
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
LONG_KEY = re.compile(rf"(?<![\w.\"'-])(?:[\w\"'-]++\s*+\.\s*+){{{MAX_DEPTH}}}")
"""A dotted key of more parts than that; tomllib's time grows with the square of their number."""

log = logging.getLogger(__name__)


@cache
def config_folder() -> Path:
    """The shipped ``config`` folder: inside the wheel, or beside the package in a checkout."""
    package = Path(__file__).parents[1]
    inside = package / "config"
    return inside if inside.is_dir() else package.parent / "config"


def own_venues_folder() -> Path:
    """The folder of the venues that were set up on this machine, in the data folder; it need not exist."""
    return data_folder() / "venues"


def load_settings(
    venue: str | None = None, config: Path | None = None, options: Mapping[str, Any] | None = None
) -> Settings:
    """Merge all layers and check them.

    venue: a name of config/venues or a path; config: a further file; options: dotted keys,
    ``{"server.port": 8001}``, of which None values are left out. Raises SettingsError.
    """
    return settings_from_layers(layers_of(venue, config, options))


def layers_of(
    venue: str | None = None, config: Path | None = None, options: Mapping[str, Any] | None = None
) -> list[Layer]:
    """All sources of values, the lowest first; as ``load_settings``. Raises SettingsError when one cannot be read."""
    upper = []
    if venue is not None:
        upper.append(read_layer(find_file("venues", venue), LayerKind.VENUE))
    if config is not None:
        upper.append(read_layer(config, LayerKind.CONFIG))
    upper.append(Layer(OPTIONS, nested(options or {}), kind=LayerKind.OPTIONS))
    return _over_shipped(upper)


def layers_of_text(path: Path, text: str) -> list[Layer]:
    """All sources of values for a venue's file with this text, which need not be written yet. Raises SettingsError."""
    return _over_shipped([_layer(path, text, LayerKind.VENUE), Layer(OPTIONS, {}, kind=LayerKind.OPTIONS)])


def with_overlay(layers: Sequence[Layer], overlay: Mapping[str, Any]) -> list[Layer]:
    """Layers of ``layers_of`` with what was changed on the page between the files and the command line.

    overlay: dotted keys, in place of an earlier overlay of these layers. Files are read only when it names another
    field or pattern. Raises SettingsError when one of them cannot be read, or the keys cannot be settings.
    """
    table = nested(overlay, PAGE)
    if depth(table) > MAX_DEPTH:
        raise SettingsError(PAGE, found=f"tables in more than {MAX_DEPTH} others", accepted="values of settings")
    page = Layer(PAGE, table, kind=LayerKind.PAGE)
    _rename(page)
    names_files = _names_files(page) or any(_names_files(layer) for layer in layers if layer.kind is LayerKind.PAGE)
    _make_absolute(table, Path.cwd())
    *below, options = (layer for layer in layers if layer.kind is not LayerKind.PAGE)
    if not names_files:
        return [*below, page, options]
    own = [layer for layer in below if layer.kind in (LayerKind.VENUE, LayerKind.CONFIG)]
    return _over_shipped([*own, page, options])


def _names_files(layer: Layer) -> bool:
    return any(lookup(layer.table, key.split("."))[0] for key in FILE_NAMES)


def _over_shipped(upper: Iterable[Layer]) -> list[Layer]:
    """Layers over the defaults, the field and the patterns that they choose."""
    upper = list(upper)
    lowest = read_layer(config_folder() / "default.toml", LayerKind.DEFAULT)
    preset = lowest.table["field_preset"]
    for layer in upper:
        preset = layer.table.get("field_preset", preset)
    field = read_layer(find_file("fields", str(preset)), LayerKind.FIELD)
    robots = {key: value for layer in (lowest, *upper) for key, value in _robots(layer).items()}
    return [lowest, field, *_pattern_layers(robots), *upper]


def _robots(layer: Layer) -> Table:
    robots = layer.table.get("robots")
    return robots if isinstance(robots, dict) else {}


def _pattern_layers(robots: Table) -> list[Layer]:
    """Outline, size and height of the robots, as the files of their patterns give them."""
    layers = []
    for path, table in (((), robots), *(((team,), robots.get(team)) for team in ("blue", "yellow"))):
        names = table.get("pattern") if isinstance(table, dict) else None
        name = names[0] if isinstance(names, list) and names else names  # of several, the first one has the body
        if isinstance(name, str):
            pattern = read_layer(find_file("patterns", name))
            body = nested({".".join(("robots", *path)): pattern.table.get("robot", {})})
            layers.append(Layer(pattern.name, body, kind=LayerKind.PATTERN))
    return layers


def settings_from_layers(layers: Sequence[Layer], *, complete_palette: bool = True) -> Settings:
    """Merge layers, later wins, and check the result.

    complete_palette: the colors of the ball must have classes; False for commands that help to make a palette.
    Raises SettingsError naming file, line and key.
    """
    whole: Table = {}
    for layer in layers:
        whole = with_one_palette(merged(whole, layer.table), layer.table)
    whole = with_own_light(whole, layers)
    for keys, number in numbers(whole, []):
        if not math.isfinite(number):
            raise SettingsError(f"{place(keys, layers)}: {'.'.join(keys)}", found=str(number), accepted="a number")
    try:
        settings = msgspec.convert(whole, Settings)
    except msgspec.ValidationError as error:
        raise explained(str(error), whole, layers) from None
    check_settings(settings, lambda key: place_of(key, layers), complete_palette=complete_palette)
    return settings


def find_file(kind: str, name: str) -> Path:
    """A shipped file of config/<kind> or a venue of one's own by its name, or any file by a path that ends with .toml.

    Raises SettingsError.
    """
    if name.endswith(".toml"):
        return Path(name)
    folders = [config_folder() / kind, *([own_venues_folder()] if kind == "venues" else [])]
    known = {path.stem: path for folder in reversed(folders) for path in sorted(folder.glob("*.toml"))}
    if name in known:
        return known[name]
    raise SettingsError(
        f"{kind[:-1]} {name!r}",
        found="no such file",
        accepted=f"{', '.join(sorted(known))}, or a path that ends with .toml",
    )


def read_layer(path: Path, kind: LayerKind = LayerKind.CONFIG) -> Layer:
    """One TOML file, with keys by their present names and files by absolute paths. Raises SettingsError."""
    text = read_text(path, f"configuration file {path}", SettingsError, max_bytes=MAX_FILE_BYTES)
    return _layer(path, text, kind)


def _layer(path: Path, text: str, kind: LayerKind) -> Layer:
    asked = f"configuration file {path}"
    if LONG_KEY.search(text):
        raise SettingsError(asked, found=f"a key of more than {MAX_DEPTH} parts", accepted="keys of this file's kind")
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # no TOML; brackets without end
        raise SettingsError(asked, found=str(error), accepted="TOML") from None
    if depth(table) > MAX_DEPTH:
        raise SettingsError(asked, found=f"tables in more than {MAX_DEPTH} others", accepted="keys of this file's kind")
    layer = Layer(str(path), table, text, kind)
    _rename(layer)
    _make_absolute(table, path.absolute().parent)
    return layer


def _rename(layer: Layer) -> None:
    """Give values of a layer that stand under a former key their present one, and log that."""
    for old, new in RENAMED.items():
        *parents, last = old.split(".")
        is_there, table = lookup(layer.table, parents)
        if not is_there or not isinstance(table, dict) or last not in table:
            continue
        line = line_of(layer.text, [*parents, last])
        where = layer.name if line is None else f"{layer.name}, line {line}"
        present = new.rpartition(".")[2]
        if present in table:
            raise SettingsError(f"{where}: {old}", found=f"{new} as well, its present name", accepted="one of them")
        table[present] = table.pop(last)
        log.warning("%s is now called %s (%s)", old, new, where)


def _absolute(name: Any, folder: Path) -> Any:
    return str(folder / name) if isinstance(name, str) and name.endswith(".toml") else name


def _make_absolute(table: Table, folder: Path) -> None:
    """Make relative names of files absolute, from the folder of the file that they stand in."""
    for key in FILE_NAMES:
        *parents, last = key.split(".")
        _, parent = lookup(table, parents)
        if not isinstance(parent, dict) or last not in parent:
            continue
        names = parent[last]
        parent[last] = (
            [_absolute(name, folder) for name in names] if isinstance(names, list) else _absolute(names, folder)
        )
    _, source = lookup(table, ["source"])
    if isinstance(source, dict) and re.match("file:.", uri := str(source.get("uri", ""))):
        source["uri"] = f"file:{folder / uri.removeprefix('file:')}"
