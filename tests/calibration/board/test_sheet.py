"""Boards are printed true to scale, and what is printed is what is searched."""

import re
from pathlib import Path

import numpy as np
import pytest

from tests.patterns.test_sheets import NUMBER, POINTS_PER_MM, pages_of
from vision_core.calibration.board.board import BOARDS, Board
from vision_core.calibration.board.corners import BoardView, find_board
from vision_core.calibration.board.sheet import FORMS, board_pdf, board_png, board_svg, write_board
from vision_core.errors import SettingsError, SourceError
from vision_core.geometry import Floats
from vision_core.native.opencv import read_picture
from vision_core.patterns.sheets import RULER_MM


def painted(boxes: Floats, board: Board) -> np.ndarray:
    """Rectangles on the page [mm] as the modules that they blacken; fails when one lies between modules."""
    left, top = (
        (page - count * board.square_mm) / 2.0
        for page, count in zip(board.page_mm, (board.columns, board.rows), strict=True)
    )
    modules = (boxes - (left, top, 0.0, 0.0)) / board.module_mm
    whole = modules.round().astype(int)
    assert np.abs(modules - whole).max() < 0.01
    black = np.zeros((board.rows * 8, board.columns * 8), dtype=bool)
    for x, y, width, height in whole.tolist():
        assert not black[y : y + height, x : x + width].any(), "rectangles do not overlap"
        black[y : y + height, x : x + width] = True
    return black


@pytest.mark.parametrize("board", BOARDS.values(), ids=list(BOARDS))
def test_squares_and_rulers_of_the_pdf_are_true_to_scale(board: Board) -> None:
    (page,) = pages_of(board_pdf(board))
    found = re.findall(rf"{NUMBER} {NUMBER} {NUMBER} {NUMBER} re f", page)
    boxes = np.array(found, dtype=float) / POINTS_PER_MM
    boxes[:, 1] = board.page_mm[1] - boxes[:, 1]
    boxes[:, 3] = np.abs(boxes[:, 3])
    assert (painted(boxes, board) == board.modules()).all()
    lines = np.array(re.findall(rf"{NUMBER} {NUMBER} m {NUMBER} {NUMBER} l S", page), dtype=float) / POINTS_PER_MM
    lengths = np.abs(lines[:, 2:] - lines[:, :2]).max(axis=0)
    assert lengths == pytest.approx([RULER_MM, RULER_MM], abs=0.01)


def test_the_svg_shows_the_same() -> None:
    board = BOARDS["A4"]
    text = board_svg(board).decode()
    assert 'width="210mm" height="297mm" viewBox="0 0 210 297"' in text
    boxes = re.findall(rf"M{NUMBER} {NUMBER}h{NUMBER}v{NUMBER}h{NUMBER}z", text)
    assert (painted(np.array(boxes, dtype=float)[:, :4], board) == board.modules()).all()
    assert f"h{RULER_MM}M" in text
    assert f"v{RULER_MM}M" in text


def test_the_picture_is_found_and_tells_its_paper(tmp_path: Path) -> None:
    for board in BOARDS.values():
        write_board(board, tmp_path / "board.png")
        view = find_board(read_picture(tmp_path / "board.png"))
        assert isinstance(view, BoardView)
        assert (view.board, len(view)) == (board, 35)
        assert view.pixels == pytest.approx(view.points * 128.0 + 127.5, abs=0.1)


def test_refusals(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"found: .tiff; accepted: a name that ends with .pdf, .svg, .png"):
        write_board(BOARDS["A4"], tmp_path / "board.tiff")
    for ending in FORMS:
        with pytest.raises(SourceError, match="accepted: a file to write"):
            write_board(BOARDS["A4"], tmp_path / "none" / f"board.{ending}")
    assert board_png(BOARDS["A4"]).startswith(b"\x89PNG")
