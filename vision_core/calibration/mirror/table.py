"""Tables of two columns from CSV or pasted text: a radius or a direction, and a distance on the floor [mm].

Cells are separated by semicolons, tabs or commas, or by spaces where there are none of these; a byte order mark, quoted
cells, empty lines and lines that begin with # are allowed. A header names the columns by their units (px or deg; mm, cm
or m) in any order, and other columns are ignored; without one there are two columns in that order, the distance in
millimetres. Where commas do not separate cells they are decimal commas.
"""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

from vision_core.errors import SettingsError

MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


@dataclass(frozen=True, slots=True)
class FirstColumn:
    """What stands beside the distance."""

    name: str
    unit: str

    @property
    def two_columns(self) -> str:
        """Of a table without a header, in words."""
        return f"two columns, {self.name} in {self.unit} and r in mm"


RADII, DIRECTIONS = FirstColumn("R", "px"), FirstColumn("the direction", "deg")


@dataclass(frozen=True, slots=True)
class TableRow:
    """One line."""

    line: int
    values: tuple[float, float]
    """Radius [px] or direction [deg], and distance [mm]."""


def rows_of(text: str, first: FirstColumn, asked: str) -> list[TableRow]:
    """The rows of a table, one at least. asked: what messages call it. Raises SettingsError naming its line."""
    rows = []
    columns: _Columns | None = None
    for line, cells in _cells(text.removeprefix("\ufeff"), asked):
        where = f"{asked}, line {line}"
        if columns is None:
            columns = _columns(cells, first, where)
            if columns.is_header:
                continue
        rows.append(TableRow(line, columns.values(cells, where)))
    if not rows:
        raise SettingsError(asked, found="no pair", accepted=f"{first.two_columns}, one pair a line")
    return rows


@dataclass(frozen=True, slots=True)
class _Columns:
    """Where the values stand."""

    first: FirstColumn
    place: int
    distance: int
    mm: float
    """Of a unit of the distance."""
    is_header: bool

    def values(self, cells: Sequence[str], where: str) -> tuple[float, float]:
        """Of a line."""
        if self.is_header and len(cells) <= max(self.place, self.distance):
            raise SettingsError(where, found=f"{len(cells)} cells: {'; '.join(cells)}", accepted="both columns")
        if not self.is_header and len(cells) != 2:
            found = f"{len(cells)} cells: {'; '.join(cells)}"
            commas = " (with decimal commas, separate the cells by semicolons)" if len(cells) > 2 else ""
            raise SettingsError(where, found=found, accepted=f"{self.first.two_columns}{commas}")
        return _number(cells[self.place], where), _number(cells[self.distance], where) * self.mm


def _columns(cells: Sequence[str], first: FirstColumn, where: str) -> _Columns:
    """By the first line that is not empty."""
    if all(NUMBER.fullmatch(cell) for cell in cells):
        return _Columns(first, 0, 1, 1.0, is_header=False)
    units = [_unit(cell, first) for cell in cells]
    places = [place for place, unit in enumerate(units) if unit == first.unit]
    distances = [place for place, unit in enumerate(units) if unit in MM]
    if any(NUMBER.fullmatch(cell) for cell in cells) or len(places) != 1 or len(distances) != 1:
        header = f"a header that names the units: {first.unit} for {first.name}, and mm, cm or m for r"
        raise SettingsError(where, found="; ".join(cells), accepted=f"{first.two_columns}; or {header}")
    return _Columns(first, places[0], distances[0], MM[units[distances[0]]], is_header=True)


def _unit(cell: str, first: FirstColumn) -> str:
    """The unit that a header names: "R [px]", "r_mm", "distance (cm)"; empty: none."""
    last = re.split(r"[^a-z]+", cell.lower().rstrip("])} "))[-1]
    return last if last == first.unit or last in MM else ""


def _cells(text: str, asked: str) -> list[tuple[int, list[str]]]:
    """Line number and cells of every line that is not empty and no comment; numbers with a decimal point."""
    lines = text.splitlines()
    plain = "\n".join(line for line in lines if not line.lstrip().startswith("#"))
    delimiter = next((mark for mark in ";\t," if mark in plain), " ")
    found = []
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = _split(line.strip() if delimiter == " " else line, delimiter, f"{asked}, line {number}")
        while cells and not cells[-1]:
            cells.pop()
        if cells:
            found.append((number, cells if delimiter == "," else [_with_point(cell) for cell in cells]))
    return found


def _split(line: str, delimiter: str, where: str) -> list[str]:
    try:
        (cells,) = csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=True)
    except (csv.Error, ValueError) as error:
        accepted = "cells with a quote at both ends, or none"
        raise SettingsError(where, found=f"{line} ({error})", accepted=accepted) from None
    return [cell.strip() for cell in cells]


def _with_point(cell: str) -> str:
    """A number with a decimal comma, written with a point; any other text as it is."""
    pointed = cell.replace(",", ".")
    return pointed if NUMBER.fullmatch(pointed) else cell


def _number(cell: str, where: str) -> float:
    if not NUMBER.fullmatch(cell):
        raise SettingsError(where, found=repr(cell), accepted="a number such as 61 or 373.5")
    return float(cell)
