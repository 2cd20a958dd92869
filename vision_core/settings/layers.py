"""Where values come from: the sources of settings, each of which overrides the ones before it."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, TypeAlias

Table: TypeAlias = dict[str, Any]


class LayerKind(StrEnum):
    """The kinds of sources, the lowest first."""

    DEFAULT = "default"
    FIELD = "field"
    PATTERN = "pattern"
    VENUE = "venue"
    CONFIG = "config"
    PAGE = "page"
    OPTIONS = "options"


@dataclass(frozen=True, slots=True)
class Layer:
    """One source of values."""

    name: str
    """What messages call it: a path, "changes made on the page", or "command line or environment"."""
    table: Table
    text: str = ""
    """Content of the file; empty for a layer that is no file, and where only the values are kept."""
    kind: LayerKind = LayerKind.CONFIG
