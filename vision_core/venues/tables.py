"""Tables of settings: find, count and merge their values. Nothing is read from files here."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from vision_core.errors import SettingsError
from vision_core.settings.layers import Layer, LayerKind, Table
from vision_core.settings.schema import SYNTHETIC
from vision_core.venues.toml_lines import line_of

REPLACED = frozenset({"colors.classes", "colors.samples"})
"""Tables that an upper layer replaces as a whole."""
MAX_DEPTH = 16
"""Most tables within each other, and most parts of a dotted key."""


def place_of(key: str, layers: Sequence[Layer]) -> str:
    """The file and line that set a key, or the name of the layer that is no file."""
    return place(key.split("."), layers)


def place(keys: list[str], layers: Sequence[Layer]) -> str:
    """The same for a key in parts."""
    layer = culprit(keys, layers)
    line = line_of(layer.text, keys)
    return layer.name if line is None else f"{layer.name}, line {line}"


def merged(below: Table, above: Table, path: str = "") -> Table:
    """A table with the values of another over its own. path: dotted, where both stand."""
    result = dict(below)
    for key, value in above.items():
        here = f"{path}.{key}" if path else key
        old = result.get(key)
        if isinstance(old, dict) and isinstance(value, dict) and here not in REPLACED:
            result[key] = merged(old, value, here)
        else:
            result[key] = value
    return result


def with_one_palette(whole: Table, above: Table) -> Table:
    """Merged tables in which no color class of the layer merged last has its old definition of the other kind too."""
    colors, new = whole.get("colors"), above.get("colors")
    if not isinstance(colors, dict) or not isinstance(new, dict):
        return whole
    colors = dict(colors)
    for kind, other in (("samples", "classes"), ("classes", "samples")):
        named, old = new.get(kind), colors.get(other)
        if isinstance(named, dict) and isinstance(old, dict) and other not in new:
            colors[other] = {name: value for name, value in old.items() if name not in named}
    return {**whole, "colors": colors}


def with_own_light(whole: Table, layers: Sequence[Layer]) -> Table:
    """Merged tables of layers without a reference of the light that belongs to other pictures or colors.

    The reference of the defaults is that of the simulated camera's carpet, in the light of the defaults' colors. It
    does not hold for a venue, another source or other colors: these have a reference of their own, or none.
    """
    at = ["colors", "light", "reference_bgr"]
    upper = [layer for layer in layers if layer.kind is not LayerKind.DEFAULT]
    if any(lookup(layer.table, at)[0] for layer in upper) or not any(_shows_other_colors(layer) for layer in upper):
        return whole
    found, light = lookup(whole, at[:2])
    if not found or not isinstance(light, dict):
        return whole
    kept = {key: value for key, value in light.items() if key != at[2]}
    return {**whole, "colors": {**whole["colors"], "light": kept}}


def _shows_other_colors(layer: Layer) -> bool:
    """Is a layer a venue, or does it choose another source than the simulated camera, or define colors?"""
    found, uri = lookup(layer.table, ["source", "uri"])
    defines = any(lookup(layer.table, ["colors", kind])[0] for kind in ("classes", "samples"))
    return layer.kind is LayerKind.VENUE or defines or (found and uri != SYNTHETIC)


def numbers(node: Any, keys: list[str]) -> Iterator[tuple[list[str], float]]:
    """Every float of a table, with its keys."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from numbers(value, [*keys, key])
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from numbers(value, [*keys, str(index)])
    elif isinstance(node, float):
        yield keys, node


def lookup(table: Any, keys: list[str]) -> tuple[bool, Any]:
    """Is there a value at a path, and which?"""
    for key in keys:
        if isinstance(table, dict) and key in table:
            table = table[key]
        elif isinstance(table, list) and key.isdigit() and int(key) < len(table):
            table = table[int(key)]
        else:
            return False, None
    return True, table


def depth(table: Any) -> int:
    """How many tables and lists lie within each other at most."""
    levels, level = 0, [table]
    while level:
        levels += 1
        inner = [list(node.values()) if isinstance(node, dict) else node for node in level]
        level = [item for items in inner for item in items if isinstance(item, (dict, list))]
    return levels


def nested(options: Mapping[str, Any], asked: str = "settings") -> Table:
    """Dotted keys as tables within each other; None values are left out.

    asked: what messages call the keys. Raises SettingsError for a key below a value, or with too many parts.
    """
    tables: Table = {}
    for key, value in options.items():
        if value is None:
            continue
        *parents, last = key.split(".")
        if len(parents) >= MAX_DEPTH:
            raise SettingsError(asked, found=f"a key of more than {MAX_DEPTH} parts", accepted="a setting's name")
        table = tables
        for parent in parents:
            below = table.get(parent, {})
            if not isinstance(below, dict):
                raise SettingsError(f"{asked}: {key}", found=f"a value for {parent} as well", accepted="one of them")
            table[parent] = table = dict(below)  # a table among the values stays as it is
        table[last] = value
    return tables


def culprit(keys: list[str], layers: Sequence[Layer]) -> Layer:
    """The uppermost layer that sets a key, or else the nearest of its parents."""
    for length in range(len(keys), 0, -1):
        for layer in reversed(layers):
            if lookup(layer.table, keys[:length])[0]:
                return layer
    return layers[-1]
