"""The colors in force when they follow the light."""

from dataclasses import dataclass

from vision_core.clock import Instant
from vision_core.types.colors import Light

MAX_CHANGES = 50
"""The last so many are kept."""


@dataclass(frozen=True, slots=True)
class ColorChange:
    """When the light or the palette was changed, and how."""

    at: Instant
    what: str
    """"light": other gains; "learned" from the robots that are read, "found" from nothing, or "start": the settings'
    palette again; "held": back to the set-up, until it is "resumed"."""
    light: Light
    """In force from then on."""
    robots: int = 0
    """Seen with a new palette in the picture that led to it."""
    read: int = 0
    """Of these, read."""


@dataclass(frozen=True, slots=True)
class PaintShift:
    """How a paint looks now, beside how the settings have it: log B/G and log R/G."""

    name: str
    set_up: tuple[float, float]
    now: tuple[float, float]
    patches: int
    """From which it was learned; 0: placed by its name."""


@dataclass(frozen=True, slots=True)
class LivePalette:
    """What the task ``perceive`` sees with: light and palette fit together."""

    changes: tuple[ColorChange, ...]
    """The last ones, oldest first."""
    light: Light
    held: bool
    """The colors of the set-up are held: nothing is adapted."""
    paints: tuple[PaintShift, ...]
    """Empty while the settings' colors are in force."""
    classes: bytes
    """Class of every cell of the color table; empty: that of the settings."""
    means: tuple[float, ...]
    """Of the table's references, row by row."""
    spreads: tuple[float, ...]
