"""Pairs of a radius in an on-board picture [px] and a distance on the floor [mm], and reading them from text."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vision_core.calibration.mirror.rounding import Rounding
from vision_core.calibration.mirror.table import RADII, rows_of
from vision_core.errors import SettingsError
from vision_core.geometry import Floats, Mask
from vision_core.user_files import read_text

MAX_PAIRS = 10_000
MAX_BYTES = 1_000_000
MAX_RADIUS_PX, MAX_DISTANCE_MM = 10_000.0, 100_000.0
HALF_PX = 0.5


@dataclass(frozen=True, slots=True)
class SharedError:
    """Standard deviations of errors that many pairs have in common: their number does not make them smaller."""

    distance_mm: float = 0.0
    radius_px: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Pairs in the order in which they were given."""

    radii_px: Floats
    """Shape (n,), as given."""
    distances_mm: Floats
    """Shape (n,)."""
    names: tuple[str, ...]
    """What messages call each: "line 7"."""
    rounding: Rounding
    shared: Floats
    """``SharedError`` of each, distance [mm] and radius [px], shape (n, 2)."""

    def __len__(self) -> int:
        return len(self.names)

    @property
    def are_cut(self) -> bool:
        """Were the radii cut to whole numbers?"""
        if self.rounding is Rounding.AUTO:
            return len(self) > 0 and bool((self.radii_px == np.floor(self.radii_px)).all())
        return self.rounding is Rounding.CUT

    @property
    def measured_px(self) -> Floats:
        """The radii to fit, shape (n,): half a pixel more than given where they were cut."""
        measured: Floats = self.radii_px + (HALF_PX if self.are_cut else 0.0)
        return measured

    def joined(self, other: "Pairs") -> "Pairs":
        """These, then the others, each as its own rounding has them."""
        radii, rounding = np.concatenate([self.measured_px, other.measured_px]), Rounding.EXACT
        if self.are_cut and other.are_cut:
            radii, rounding = radii - HALF_PX, self.rounding if self.rounding is other.rounding else Rounding.CUT
        distances = np.concatenate([self.distances_mm, other.distances_mm])
        shared = np.concatenate([self.shared, other.shared])
        return Pairs(radii, distances, (*self.names, *other.names), rounding, shared)

    def chosen(self, mask: Mask) -> "Pairs":
        """Some of them, shape (n,)."""
        names = tuple(name for name, is_chosen in zip(self.names, mask.tolist(), strict=True) if is_chosen)
        return Pairs(self.radii_px[mask], self.distances_mm[mask], names, self.rounding, self.shared[mask])


def pairs_of(
    rows: Sequence[tuple[float, float]],
    names: Sequence[str] = (),
    rounding: Rounding = Rounding.AUTO,
    shared: Sequence[SharedError] = (),
) -> Pairs:
    """Pairs (R px, r mm). names: what messages call them; () for "row 1" and so on. Raises SettingsError.

    shared: errors of each that it shares with others; () for none.
    """
    called = tuple(names) or tuple(f"row {number}" for number in range(1, len(rows) + 1))
    if len(rows) > MAX_PAIRS:
        raise SettingsError("pairs", found=f"{len(rows)} of them", accepted=f"at most {MAX_PAIRS}")
    for name, (radius, distance) in zip(called, rows, strict=True):
        _check(name, "R", radius, MAX_RADIUS_PX, "px")
        _check(name, "r", distance, MAX_DISTANCE_MM, "mm")
    columns = np.array(rows, dtype=np.float64).reshape(-1, 2)
    errors = np.zeros_like(columns)
    if shared:
        errors[:] = [(one.distance_mm, one.radius_px) for one in shared]
    return Pairs(columns[:, 0].copy(), columns[:, 1].copy(), called, rounding, errors)


def read_pairs(path: Path, rounding: Rounding = Rounding.AUTO) -> Pairs:
    """The pairs of a file. Raises SettingsError naming its line."""
    text = read_text(path, f"pairs {path}", SettingsError, max_bytes=MAX_BYTES)
    return pairs_from_text(text, rounding, asked=f"pairs {path}")


def pairs_from_text(text: str, rounding: Rounding = Rounding.AUTO, *, asked: str = "the pairs") -> Pairs:
    """The pairs of CSV or pasted text. asked: what messages call it. Raises SettingsError naming its line."""
    rows = rows_of(text, RADII, asked)
    try:
        return pairs_of([row.values for row in rows], [f"line {row.line}" for row in rows], rounding)
    except SettingsError as error:
        raise SettingsError(f"{asked}, {error.asked}", found=error.found, accepted=error.accepted) from None


def _check(name: str, what: str, value: float, most: float, unit: str) -> None:
    if not 0.0 < value <= most:
        accepted = f"more than 0 and at most {most:g} {unit}"
        raise SettingsError(name, found=f"{what} {value:g} {unit}", accepted=accepted)
