"""Printable markers, true to scale: A4 pages of PDF with cut lines, names, and a ruler that checks the printer."""

from collections.abc import Iterable
from pathlib import Path

from fpdf import FPDF

from vision_core.errors import SettingsError, SourceError
from vision_core.patterns.geometry import reach_mm
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.patterns.pattern import Pattern
from vision_core.types.objects import Team

PAGE_MM = (210.0, 297.0)
MARGIN_MM, LABEL_MM, ARROW_MM, BETWEEN_MM = 12.0, 6.0, 7.0, 4.0
RULER_MM = 100
RULER_WORDS = f"{RULER_MM} mm: print at 100 %, and measure this."
RIM_MM = 8.0
"""Width of the dark ground round the patches of a robot that is too large for a page."""
RULER_ROOM_MM = 20.0
GROUND = (30, 30, 30)
"""Tops are printed dark: no patch's color mixes with white paper."""
LINE = (120, 120, 120)

Marker = tuple[Pattern, Team, int]


def write_sheets(markers: Iterable[Marker], path: Path) -> int:
    """Write a PDF of markers, in their order; returns the number of pages.

    Every marker lies heading up on its robot's outline, the robot's center in the middle; the arrow outside of the
    cut line shows the front.
    Raises SettingsError for a color without a paint or a marker larger than a page, SourceError when the file
    cannot be written.
    """
    sheets = _Sheets()
    for pattern, team, number in markers:
        sheets.place(pattern, team, number)
    try:
        path.write_bytes(sheets.bytes())
    except OSError as error:
        raise SourceError(f"sheets {path}", found=error.strerror or str(error), accepted="a file to write") from None
    return sheets.pages


def draw_ruler(pdf: FPDF, start_mm: tuple[float, float], *, down: bool = False) -> None:
    """Draw a ruler of RULER_MM that begins at a place of the page and runs to the right, or down; its marks go up, or
    to the left. The font of small print is set."""
    x, y = start_mm
    pdf.set_draw_color(0, 0, 0)
    pdf.set_line_width(0.2)
    pdf.line(x, y, *((x, y + RULER_MM) if down else (x + RULER_MM, y)))
    for mark in range(0, RULER_MM + 1, 10):
        length = 4.0 if mark % 50 == 0 else 2.0
        at, end = ((x, y + mark), (x - length, y + mark)) if down else ((x + mark, y), (x + mark, y - length))
        pdf.line(*at, *end)
    pdf.set_font("helvetica", size=8)


class _Sheets:
    """Lays markers in rows; units are millimetres, y points down the page."""

    def __init__(self) -> None:
        self._pdf = FPDF(orientation="portrait", unit="mm", format="A4")
        self._pdf.set_auto_page_break(False)
        self._pdf.set_title("PSLV markers")
        self._x = self._y = self._row = 0.0
        self.pages = 0

    def bytes(self) -> bytes:
        return bytes(self._pdf.output())

    def place(self, pattern: Pattern, team: Team, number: int) -> None:
        """Draw a marker in the next free place."""
        side, outline = _cut(pattern)
        room = side + ARROW_MM + LABEL_MM + BETWEEN_MM
        if self.pages == 0:
            self._new_page()
        if self._x + side > PAGE_MM[0] - MARGIN_MM:
            self._x, self._y, self._row = MARGIN_MM, self._y + self._row, 0.0
        if self._y + room > PAGE_MM[1] - MARGIN_MM:
            self._new_page()
        center = (self._x + side / 2.0, self._y + ARROW_MM + side / 2.0)
        self._draw(pattern, team, number, center, side, outline)
        self._x += side + BETWEEN_MM
        self._row = max(self._row, room)

    def _new_page(self) -> None:
        self._pdf.add_page()
        self.pages += 1
        self._x, self._y, self._row = MARGIN_MM, MARGIN_MM + RULER_ROOM_MM, 0.0
        draw_ruler(self._pdf, (MARGIN_MM, MARGIN_MM + 5.0))
        self._pdf.text(MARGIN_MM, MARGIN_MM + 9.0, f"{RULER_WORDS} Matt paper; cut lines are grey.")

    def _draw(
        self, pattern: Pattern, team: Team, number: int, center: tuple[float, float], side: float, outline: str
    ) -> None:
        pdf = self._pdf
        x, y = center[0] - side / 2.0, center[1] - side / 2.0
        pdf.set_fill_color(*GROUND)
        pdf.set_draw_color(*LINE)
        pdf.set_line_width(0.15)
        if outline == "square":
            pdf.rect(x, y, side, side, style="DF")
        else:
            pdf.ellipse(x, y, side, side, style="DF")
        for patch, color in zip(pattern.layout(number), pattern.colors_worn(team, number), strict=True):
            pdf.set_fill_color(*_rgb(pattern, color))
            if patch.circle_mm is not None:
                forward, left, diameter = patch.circle_mm
                corner = center[0] - left - diameter / 2.0, center[1] - forward - diameter / 2.0
                pdf.ellipse(*corner, diameter, diameter, style="F")
            else:
                pdf.polygon(
                    [(center[0] - left, center[1] - ahead) for ahead, left in patch.polygon_mm or ()], style="F"
                )
        pdf.set_fill_color(0, 0, 0)
        top = y - ARROW_MM
        pdf.polygon([(center[0], top + 1.0), (center[0] - 2.5, top + 5.0), (center[0] + 2.5, top + 5.0)], style="F")
        pdf.set_font("helvetica", size=8)
        pdf.text(center[0] + 4.0, top + 4.5, "front")
        pdf.text(x, y + side + 4.0, f"{pattern.name} {team} {number}")


def _cut(pattern: Pattern) -> tuple[float, str]:
    """Width and form of the paper: the robot's top or, of one too large for a page, a square round its patches."""
    most = PAGE_MM[0] - 2.0 * MARGIN_MM
    if (side := 2e3 * pattern.robot.radius_m) <= most:
        return side, pattern.robot.outline
    needed = 2.0 * max(reach_mm(patch, "square") for patch in pattern.patches)
    if needed > most:
        accepted = f"at most {most:g} mm, to print it on A4"
        raise SettingsError(f"pattern {pattern.name}: patches", found=f"{needed:g} mm wide", accepted=accepted)
    return min(needed + 2.0 * RIM_MM, most), "square"


def _rgb(pattern: Pattern, color: str) -> tuple[int, int, int]:
    if color not in PAINTS_BGR:
        raise SettingsError(f"pattern {pattern.name}: paint", found=color, accepted=", ".join(PAINTS_BGR))
    blue, green, red = PAINTS_BGR[color]
    return red, green, blue
