"""A board to print, true to scale: a page of PDF or SVG with two rulers; or to show on a flat screen: PNG."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from fpdf import FPDF

from vision_core.calibration.board.board import Board
from vision_core.errors import SettingsError, SourceError
from vision_core.geometry import Mask
from vision_core.native.opencv import encode_png
from vision_core.patterns.sheets import RULER_MM, RULER_WORDS, draw_ruler

BELOW_MM, BESIDE_MM = 8.0, 11.0
"""From the page's left border to the ruler that runs down, and from the board to the words below it."""
RULER_TOP_MM = 20.0
PNG_MODULE_PX, PNG_RIM_MODULES = 16, 8

Rectangle = tuple[float, float, float, float]
"""Left, top, width and height."""


def board_pdf(board: Board) -> bytes:
    """The board in the middle of its page."""
    pdf = FPDF(orientation="portrait", unit="mm", format=board.paper)
    pdf.set_auto_page_break(False)
    pdf.set_title(f"PSLV board {board.paper}")
    pdf.add_page()
    pdf.set_fill_color(0, 0, 0)
    for box in _boxes_mm(board):
        pdf.rect(*box, style="F")
    left, top = _corner_mm(board)
    draw_ruler(pdf, (left, RULER_TOP_MM))
    draw_ruler(pdf, (BESIDE_MM, top), down=True)
    pdf.text(left + RULER_MM + 4.0, RULER_TOP_MM, RULER_WORDS)
    pdf.text(left, top + board.rows * board.square_mm + BELOW_MM, _words(board))
    return bytes(pdf.output())


def board_svg(board: Board) -> bytes:
    """The same page as SVG, in millimetres."""
    (width, height), (left, top) = board.page_mm, _corner_mm(board)
    boxes = "".join(f"M{x:g} {y:g}h{w:g}v{h:g}h{-w:g}z" for x, y, w, h in _boxes_mm(board))
    marks = range(0, RULER_MM + 1, 10)
    rulers = f"M{left:g} {RULER_TOP_MM:g}h{RULER_MM}M{BESIDE_MM:g} {top:g}v{RULER_MM}"
    rulers += "".join(f"M{left + mark:g} {RULER_TOP_MM:g}v{-_length(mark):g}" for mark in marks)
    rulers += "".join(f"M{BESIDE_MM:g} {top + mark:g}h{-_length(mark):g}" for mark in marks)
    texts = (
        (left + RULER_MM + 4.0, RULER_TOP_MM, RULER_WORDS),
        (left, top + board.rows * board.square_mm + BELOW_MM, _words(board)),
    )
    said = "".join(f'<text x="{x:g}" y="{y:g}">{words}</text>' for x, y, words in texts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{height:g}mm" '
        f'viewBox="0 0 {width:g} {height:g}" font-family="sans-serif" font-size="2.8">'
        f'<rect width="{width:g}" height="{height:g}" fill="#fff"/><path d="{boxes}"/>'
        f'<path d="{rulers}" stroke="#000" stroke-width="0.2"/>{said}</svg>'
    ).encode()


def board_png(board: Board) -> bytes:
    """The board alone with a white rim, for a screen that is flat."""
    black = np.pad(board.modules(), PNG_RIM_MODULES)
    levels = np.where(black, 0, 255).astype(np.uint8)
    return encode_png(np.kron(levels, np.ones((PNG_MODULE_PX, PNG_MODULE_PX), dtype=np.uint8)))


FORMS: dict[str, Callable[[Board], bytes]] = {"pdf": board_pdf, "svg": board_svg, "png": board_png}
"""By the endings of their files."""


def write_board(board: Board, path: Path) -> None:
    """Write a board into a file. Raises SettingsError for another ending, SourceError when it cannot be written."""
    form = FORMS.get(path.suffix.removeprefix(".").lower())
    if form is None:
        accepted = f"a name that ends with {', '.join(f'.{ending}' for ending in FORMS)}"
        raise SettingsError(f"board {path}", found=path.suffix or "no ending", accepted=accepted)
    try:
        path.write_bytes(form(board))
    except OSError as error:
        raise SourceError(f"board {path}", found=error.strerror or str(error), accepted="a file to write") from None


def _words(board: Board) -> str:
    size = f"{board.columns} x {board.rows} squares of {board.square_mm:g} mm"
    return f"PSLV board {board.paper}: {size}. Glue it onto something flat; leave the white rim."


def _length(mark: int) -> float:
    return 4.0 if mark % 50 == 0 else 2.0


def _corner_mm(board: Board) -> tuple[float, float]:
    """Of the board on the page: left and top."""
    (width, height), side = board.page_mm, board.square_mm
    return (width - board.columns * side) / 2.0, (height - board.rows * side) / 2.0


def _boxes_mm(board: Board) -> Iterator[Rectangle]:
    """The black parts of the board on its page."""
    left, top = _corner_mm(board)
    side = board.module_mm
    for x, y, width, height in _boxes(board.modules()):
        yield left + x * side, top + y * side, width * side, height * side


def _boxes(black: Mask) -> Iterator[tuple[int, int, int, int]]:
    """Black modules as few rectangles that do not overlap: left, top, width, height."""
    left_over = black.copy()
    for y, x in np.argwhere(black).tolist():
        if not left_over[y, x]:
            continue
        width = _run(left_over[y, x:])
        height = _run(np.asarray(left_over[y:, x : x + width].all(axis=1)))
        left_over[y : y + height, x : x + width] = False
        yield x, y, width, height


def _run(black: Mask) -> int:
    """How many are black from the first one on."""
    return len(black) if black.all() else int(black.argmin())
