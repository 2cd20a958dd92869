"""The palette in force when it follows the light."""

from dataclasses import dataclass

from vision_core.clock import Instant

MAX_CHANGES = 50
"""The last so many are kept."""


@dataclass(frozen=True, slots=True)
class PaletteChange:
    """When the palette was changed, and how."""

    at: Instant
    what: str
    """"learned" from the robots that are read, "found" from nothing, or "start": back to the settings' colors."""
    robots: int
    """Seen by it in the picture that led to it."""
    read: int
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
    """What the task ``perceive`` sees with."""

    changes: tuple[PaletteChange, ...]
    paints: tuple[PaintShift, ...]
    """Empty while the settings' colors are in force."""
    classes: bytes
    """Class of every cell of the color table; empty: that of the settings."""
    means: tuple[float, ...]
    """Of the table's references, row by row."""
    spreads: tuple[float, ...]
