"""All settings, one by one: value, that of the user's files, limits, and the words of the shipped settings file."""

from collections.abc import Mapping
from typing import Any, Literal

import msgspec
from msgspec import to_builtins

from app.web.configuration.comments import comments
from app.web.configuration.configuration import Configuration, flat
from app.web.reports.base import Report
from vision_core.settings.live import is_live
from vision_core.settings.schema import Settings

Kind = Literal["boolean", "integer", "number", "text", "choice", "json"]
KINDS: Mapping[str, Kind] = {"boolean": "boolean", "integer": "integer", "number": "number", "string": "text"}


class SettingReport(Report):
    """One setting."""

    key: str
    """Dotted, as in the settings files: ``match.blue_defends``."""
    description: str
    """What the shipped settings file says about it; empty where it says nothing."""
    kind: Kind
    """How it is entered; json: a list or table."""
    minimum: float | None
    maximum: float | None
    choices: list[str]
    """Of a choice."""
    value: Any
    """In effect, or with the next start."""
    file_value: Any
    """Without the changes of the page."""
    is_changed: bool
    """The page has changed it."""
    is_live: bool
    """A change takes effect at the next frame; otherwise with the next start of the service."""
    waits_for_restart: bool
    """It was changed and takes effect with the next start."""


def catalog_of(configuration: Configuration) -> list[SettingReport]:
    """Every setting, in the order of the schema."""
    values, files = flat(to_builtins(configuration.settings)), flat(to_builtins(configuration.base))
    waiting = set(configuration.waiting_for_restart())
    schema = _Schema()
    return [
        SettingReport(
            key=key,
            description=comments().get(key) or schema.description(key),
            value=value,
            file_value=files.get(key),
            is_changed=value != files.get(key),
            is_live=is_live(key),
            waits_for_restart=key in waiting,
            **schema.limits(key, value),
        )
        for key, value in (files | values).items()
    ]


class _Schema:
    """The JSON schema of the settings, by dotted keys."""

    def __init__(self) -> None:
        schema = msgspec.json.schema(Settings)
        self._definitions = schema["$defs"]
        self._root = self._resolved(schema)

    def description(self, key: str) -> str:
        return str(self._node(key).get("description", ""))

    def limits(self, key: str, value: Any) -> dict[str, Any]:
        """Kind, limits and choices of a setting, which may be of several types: its value's is taken."""
        node = self._node(key)
        kind = "string" if isinstance(value, str) else str(node.get("type"))
        choices = [str(choice) for choice in node.get("enum", [])]
        return {
            "kind": "choice" if choices else KINDS.get(kind, "json"),
            "minimum": node.get("minimum", node.get("exclusiveMinimum")),
            "maximum": node.get("maximum", node.get("exclusiveMaximum")),
            "choices": choices,
        }

    def _node(self, key: str) -> Mapping[str, Any]:
        node = self._root
        for part in key.split("."):
            below = node.get("properties", {}).get(part, node.get("additionalProperties", {}))
            node = self._resolved(below if isinstance(below, Mapping) else {})
        return node

    def _resolved(self, node: Mapping[str, Any]) -> Mapping[str, Any]:
        """The node itself, or the one that it refers to; of a choice of types the first."""
        for option in node.get("anyOf", [node]):
            if "$ref" in option:
                return {
                    **self._definitions[option["$ref"].rsplit("/", 1)[1]],
                    **{k: v for k, v in node.items() if k != "anyOf"},
                }
        if "allOf" in node:
            return self._resolved(node["allOf"][0])
        return node
