"""What is odd about a palette: classes that look like another paint, and samples that contradict each other."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from vision_core.color.lookup_table import cell_centers
from vision_core.color.samples import bgr_from_hex, hex_from_bgr, sampled_names
from vision_core.color.spaces import ycc_from_bgr
from vision_core.geometry import Floats
from vision_core.settings.schema import ColorSettings
from vision_core.types.colors import ColorTable
from vision_core.venues.violation import Violation

HUES_BGR = {
    "red": (40, 40, 220),
    "orange": (30, 120, 250),
    "yellow": (40, 210, 235),
    "green": (70, 200, 60),
    "cyan": (220, 210, 40),
    "blue": (200, 90, 20),
    "purple": (170, 50, 120),
    "magenta": (225, 45, 225),
    "pink": (190, 70, 235),
}
"""Colors by their names: blue, green, red."""
MIN_MODULE = 18.0
"""A color with less chroma than this looks like no color at all."""
MAX_OFF_DEG, MIN_SHARE = 50.0, 0.1
"""A class has its name when such a share of its colors is so near to it in hue: papers, lamps and tastes differ."""
LUMA_WEIGHT = 0.15
"""Weight of a level of luma beside one of chroma in the distance of two samples."""
SAME_SAMPLE, FAR_SAMPLE = 6.0, 30.0
"""Samples of two classes nearer to each other than this are one color; one that is farther than this from all others of
its class is not of the same paint [grey levels]."""


def palette_warnings(colors: ColorSettings, table: ColorTable) -> Iterator[Violation]:
    """Everything that is odd; table: compiled from the colors."""
    yield from _misnamed(colors, table)
    yield from _contradictory(colors)
    yield from _far_from_class(colors)


def _misnamed(colors: ColorSettings, table: ColorTable) -> Iterator[Violation]:
    """Classes whose reference looks like another color than their name says."""
    looks = {name: look for name in table.names[1:] if (look := _look_of(name, colors, table))}
    for name, (other, color) in looks.items():
        key = f"colors.{'samples' if name in colors.samples else 'classes'}.{name}"
        is_swapped = other in looks and looks[other][0] == name
        swapped = f"; {other} looks {name}: the two are exchanged" if is_swapped else ""
        yield Violation(key, f"class {name} looks {other} ({color}){swapped}", f"colors that look {name}")


def _look_of(name: str, colors: ColorSettings, table: ColorTable) -> tuple[str, str] | None:
    """The color that a class looks like if that is not its name, and its reference; None for names of no known hue."""
    if name not in HUES_BGR:
        return None
    members = np.array([bgr_from_hex(text) for text in colors.samples.get(name, ())], dtype=np.float64)
    if not len(members):
        members = cell_centers()[table.classes == table.index(name)]
    chroma = ycc_from_bgr(members.reshape(-1, 3))[:, 1:]
    colored = np.hypot(*chroma.T) >= MIN_MODULE
    if not colored.any() or (_apart_deg(chroma[colored], HUES_BGR[name]) <= MAX_OFF_DEG).mean() >= MIN_SHARE:
        return None
    reference = np.median(members[colored], axis=0)
    middle = ycc_from_bgr(reference.reshape(1, 3))[:, 1:]
    nearest = min(HUES_BGR, key=lambda other: float(_apart_deg(middle, HUES_BGR[other])[0]))
    return (nearest, hex_from_bgr(reference.tolist())) if nearest != name else None


def _apart_deg(chroma: Floats, bgr: tuple[int, int, int]) -> Floats:
    """Differences in hue of chromas, shape (n, 2), from a color: shape (n,) [deg]."""
    cb, cr = ycc_from_bgr(np.array([bgr], dtype=np.float64))[0, 1:]
    turns = np.degrees(np.arctan2(chroma[:, 1], chroma[:, 0]) - np.arctan2(cr, cb))
    apart: Floats = np.abs((turns + 180.0) % 360.0 - 180.0)
    return apart


def _contradictory(colors: ColorSettings) -> Iterator[Violation]:
    """Samples of two classes that are one color."""
    places = _places(colors)
    for one, other in combinations(colors.samples, 2):
        for text, place in zip(colors.samples[one], places[one], strict=True):
            away = np.sqrt(((places[other] - place) ** 2).sum(axis=1))
            if len(away) and 0.0 < away.min() <= SAME_SAMPLE:  # equal ones are refused
                twin = colors.samples[other][int(away.argmin())]
                found = f"{twin} is {away.min():.1f} from {text} of {one}: one color in two classes"
                yield Violation(f"colors.samples.{other}", found, f"samples at least {SAME_SAMPLE:g} apart")


def _far_from_class(colors: ColorSettings) -> Iterator[Violation]:
    """Samples that lie among those of another class."""
    places = _places(colors)
    for name in sampled_names(colors.samples):
        for number, (text, place) in enumerate(zip(colors.samples[name], places[name], strict=True)):
            own = np.sqrt(((np.delete(places[name], number, axis=0) - place) ** 2).sum(axis=1))
            if not len(own) or own.min() <= FAR_SAMPLE:
                continue
            others = {
                other: np.sqrt(((places[other] - place) ** 2).sum(axis=1)).min()
                for other in sampled_names(colors.samples)
                if other != name and len(places[other])
            }
            nearest = min(others, key=lambda other: others[other], default="")
            if nearest and others[nearest] < own.min():
                found = f"{text} is {own.min():.0f} from all others of {name}, and {others[nearest]:.0f} from {nearest}"
                yield Violation(f"colors.samples.{name}", found, "samples of one paint in different light")


def _places(colors: ColorSettings) -> dict[str, Floats]:
    """Samples as places: luma, weighted less, and chroma; per class shape (n, 3)."""
    scale = np.array([LUMA_WEIGHT, 1.0, 1.0])
    return {
        name: ycc_from_bgr(np.array([bgr_from_hex(text) for text in texts], dtype=np.float64).reshape(-1, 3)) * scale
        for name, texts in colors.samples.items()
    }
