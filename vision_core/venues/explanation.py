"""What is wrong with a value, in words: msgspec's message with file, line and key, and what would be accepted."""

import difflib
import re
from collections.abc import Sequence
from typing import Any

import msgspec

from vision_core.errors import SettingsError
from vision_core.settings.layers import Layer, Table
from vision_core.settings.schema import ColorRange, HexColor, MirrorConstants, Settings, TaskSettings
from vision_core.venues.tables import lookup, place

KINDS = {"int": "a whole number", "float": "a number", "str": "a text", "object": "a table", "array": "a list"}
"""Types in msgspec's messages, in words."""
DICTS = {
    "colors.classes": tuple[ColorRange, ...],
    "colors.samples": tuple[HexColor, ...],
    "mirror.robots": MirrorConstants,
    "tasks": TaskSettings,
}
"""Settings whose keys are names of the user's choice, with the type of their values."""


def explained(message: str, merged: Table, layers: Sequence[Layer]) -> SettingsError:
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
            f"{place([*keys, bad], layers)}: {name}",
            found=f"no setting of this name{hint}",
            accepted=", ".join(known),
        )
    if missing := re.search(r"missing required field `(.*)`", text):
        keys = [*keys, missing.group(1)]
        return SettingsError(f"{place(keys, layers)}: {'.'.join(keys)}", found="nothing", accepted="a value")
    is_there, value = lookup(merged, keys)
    return SettingsError(
        f"{place(keys, layers)}: {'.'.join(keys)}",
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
    for name, entry in lookup(merged, keys)[1].items():
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
