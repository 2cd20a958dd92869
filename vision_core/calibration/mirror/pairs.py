"""Pairs of a radius in an on-board picture [px] and a distance on the floor [mm], and reading them from text.

Text is CSV: cells separated by semicolons, tabs or commas, or by spaces where there are none of these; a byte order
mark, quoted cells, empty lines and lines that begin with # are allowed. A header names the columns by their units (px;
mm, cm or m) in any order, and other columns are ignored; without one there are two columns, R in pixels and r in
millimetres. Where commas do not separate cells they are decimal commas.

*Whole radii.* Equation 1 cuts R to a whole number, and so is everything that was read from a ``see`` message: the true
radius lies in [R, R + 1). Half a pixel is added to such radii, which makes the mean error 0 and leaves 1/sqrt(12) px.
Without a word from the user, pairs count as cut when all of their radii are whole numbers; the verdict says so.
"""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Floats
from vision_core.user_files import read_text

MAX_PAIRS = 10_000
MAX_BYTES = 1_000_000
MAX_RADIUS_PX, MAX_DISTANCE_MM = 10_000.0, 100_000.0
HALF_PX = 0.5
MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
TWO_COLUMNS = "two columns, R in px and r in mm"
HEADER = "a header that names the units: px for the radius, and mm, cm or m for the distance"


class Rounding(StrEnum):
    """What the radii of pairs are."""

    AUTO = "auto"
    """Cut when all of them are whole numbers, else exact."""
    CUT = "int"
    """Cut to whole numbers, as in ``see``: half a pixel is added."""
    EXACT = "exact"
    """As they were measured."""


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Pairs in the order in which they were given."""

    radii_px: Floats
    """Shape (n,), as given."""
    distances_mm: Floats
    """Shape (n,)."""
    names: tuple[str, ...]
    """What messages call each: "line 7"."""
    rounding: Rounding = Rounding.AUTO

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
        return Pairs(radii, distances, (*self.names, *other.names), rounding)


def pairs_of(
    rows: Sequence[tuple[float, float]], names: Sequence[str] = (), rounding: Rounding = Rounding.AUTO
) -> Pairs:
    """Typed pairs (R px, r mm). names: what messages call them; () for "row 1" and so on. Raises SettingsError."""
    called = tuple(names) or tuple(f"row {number}" for number in range(1, len(rows) + 1))
    if len(rows) > MAX_PAIRS:
        raise SettingsError("pairs", found=f"{len(rows)} of them", accepted=f"at most {MAX_PAIRS}")
    for name, (radius, distance) in zip(called, rows, strict=True):
        _check(name, "R", radius, MAX_RADIUS_PX, "px")
        _check(name, "r", distance, MAX_DISTANCE_MM, "mm")
    columns = np.array(rows, dtype=np.float64).reshape(-1, 2)
    return Pairs(columns[:, 0].copy(), columns[:, 1].copy(), called, rounding)


def read_pairs(path: Path, rounding: Rounding = Rounding.AUTO) -> Pairs:
    """The pairs of a file. Raises SettingsError naming its line."""
    text = read_text(path, f"pairs {path}", SettingsError, max_bytes=MAX_BYTES)
    return pairs_from_text(text, rounding, asked=f"pairs {path}")


def pairs_from_text(text: str, rounding: Rounding = Rounding.AUTO, *, asked: str = "the pairs") -> Pairs:
    """The pairs of CSV or pasted text. asked: what messages call it. Raises SettingsError naming its line."""
    rows, names = [], []
    columns: _Columns | None = None
    for line, cells in _cells(text.removeprefix("\ufeff"), asked):
        where = f"{asked}, line {line}"
        if columns is None:
            columns = _columns(cells, where)
            if columns.is_header:
                continue
        rows.append(columns.pair(cells, where))
        names.append(f"line {line}")
    if not rows:
        raise SettingsError(asked, found="no pair", accepted=f"{TWO_COLUMNS}, one pair a line")
    try:
        return pairs_of(rows, names, rounding)
    except SettingsError as error:
        raise SettingsError(f"{asked}, {error.asked}", found=error.found, accepted=error.accepted) from None


@dataclass(frozen=True, slots=True)
class _Columns:
    """Where radius and distance stand."""

    radius: int
    distance: int
    mm: float
    """Of a unit of the distance."""
    count: int | None
    """Cells that a line must have; None: at least those two."""
    is_header: bool

    def pair(self, cells: Sequence[str], where: str) -> tuple[float, float]:
        """R [px] and r [mm] of a line."""
        if len(cells) != self.count if self.count else len(cells) <= max(self.radius, self.distance):
            found = f"{len(cells)} cells: {'; '.join(cells)}"
            commas = " (with decimal commas, separate the cells by semicolons)" if len(cells) > 2 else ""
            raise SettingsError(where, found=found, accepted=f"{TWO_COLUMNS}{commas}" if self.count else "both columns")
        return _number(cells[self.radius], where), _number(cells[self.distance], where) * self.mm


def _columns(cells: Sequence[str], where: str) -> _Columns:
    """By the first line that is not empty."""
    if all(NUMBER.fullmatch(cell) for cell in cells):
        return _Columns(0, 1, 1.0, 2, is_header=False)
    units = [_unit(cell) for cell in cells]
    radii = [place for place, unit in enumerate(units) if unit == "px"]
    distances = [place for place, unit in enumerate(units) if unit in MM]
    if any(NUMBER.fullmatch(cell) for cell in cells) or len(radii) != 1 or len(distances) != 1:
        raise SettingsError(where, found="; ".join(cells), accepted=f"{TWO_COLUMNS}; or {HEADER}")
    return _Columns(radii[0], distances[0], MM[units[distances[0]]], None, is_header=True)


def _unit(cell: str) -> str:
    """The unit that a header names: "R [px]", "r_mm", "distance (cm)"; empty: none."""
    last = re.split(r"[^a-zµ]+", cell.lower().rstrip("])} "))[-1]
    return last if last == "px" or last in MM else ""


def _cells(text: str, asked: str) -> list[tuple[int, list[str]]]:
    """Line number and cells of every line that is not empty and no comment; numbers with a decimal point."""
    lines = text.splitlines()
    plain = "\n".join(line for line in lines if not line.lstrip().startswith("#"))
    delimiter = next((mark for mark in ";\t," if mark in plain), " ")
    found = []
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            (cells,) = csv.reader(
                [line.strip() if delimiter == " " else line],
                delimiter=delimiter,
                skipinitialspace=True,
                strict=True,
            )
        except (csv.Error, ValueError) as error:
            accepted = "cells with a quote at both ends, or none"
            raise SettingsError(f"{asked}, line {number}", found=f"{line} ({error})", accepted=accepted) from None
        cells = [cell.strip() for cell in cells]
        while cells and not cells[-1]:
            cells.pop()
        if cells:
            found.append((number, cells if delimiter == "," else [_with_point(cell) for cell in cells]))
    return found


def _with_point(cell: str) -> str:
    """A number with a decimal comma, written with a point; any other text as it is."""
    pointed = cell.replace(",", ".")
    return pointed if NUMBER.fullmatch(pointed) else cell


def _number(cell: str, where: str) -> float:
    if not NUMBER.fullmatch(cell):
        raise SettingsError(where, found=repr(cell), accepted="a number such as 61 or 373.5")
    return float(cell)


def _check(name: str, what: str, value: float, most: float, unit: str) -> None:
    if not 0.0 < value <= most:
        accepted = f"more than 0 and at most {most:g} {unit}"
        raise SettingsError(name, found=f"{what} {value:g} {unit}", accepted=accepted)
