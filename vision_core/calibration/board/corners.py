"""Corners of a board in a picture, and what keeps them from being seen."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.calibration.board.board import BOARDS, Board
from vision_core.geometry import Bytes, Floats
from vision_core.native.opencv import luma_picture

MIN_CORNERS = 8
MIN_SIDE = 1.5
"""Corners that count span at least so many squares in both directions."""
DARK, BRIGHT = 40.0, 250.0
"""A picture whose brightest hundredth is darker, or of which half is brighter, shows no board [grey levels]."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardView:
    """The corners of a board in one picture."""

    board: Board
    numbers: NDArray[np.intp]
    """Of the corners, shape (n,)."""
    pixels: Floats
    """Shape (n, 2)."""

    @property
    def points(self) -> Floats:
        """The corners on the board, in squares; shape (n, 2)."""
        points: Floats = self.board.corners[self.numbers]
        return points

    def __len__(self) -> int:
        return len(self.numbers)


def find_board(pixels: Bytes, boards: Sequence[Board] = tuple(BOARDS.values())) -> BoardView | str:
    """The board of which most is seen in a picture, shape (height, width, 3), or why none is."""
    luma = luma_picture(pixels)
    seen = _best(luma, boards)
    if len(seen) >= MIN_CORNERS and _spans(seen.points):
        return seen
    if len(seen):
        return f"only {len(seen)} corners of the board are seen, {MIN_CORNERS} over two rows are needed"
    if (bright := float(np.percentile(luma[::4, ::4], 99))) < DARK:
        return f"it is too dark: 99 % of it is below level {bright:.0f}"
    if float(np.median(luma[::4, ::4])) > BRIGHT:
        return "it is overexposed"
    if len(_best(np.ascontiguousarray(luma[:, ::-1]), boards)):
        return "it is a mirror image"
    return "no board is seen: covered, blurred, or too small"


def _best(luma: Bytes, boards: Sequence[Board]) -> BoardView:
    views = [BoardView(board, *board.pattern.find(luma)) for board in boards]
    return max(views, key=len)


def _spans(points: Floats) -> bool:
    """Are points spread over more than one line of corners, whichever way it runs?"""
    centered = points - points.mean(axis=0)
    return bool(np.linalg.svd(centered, compute_uv=False)[-1] / np.sqrt(len(points)) > MIN_SIDE / np.sqrt(12.0))
