"""The boards that are printed: squares with a marker in every white one, whose numbers tell which board it is."""

from dataclasses import dataclass
from functools import cached_property

from vision_core.geometry import Floats, Mask
from vision_core.native.charuco import SQUARE_MODULES, CharucoBoard

COLUMNS, ROWS = 6, 8


@dataclass(frozen=True)
class Board:
    """A board on a sheet of paper."""

    paper: str
    """A4 or A3."""
    page_mm: tuple[float, float]
    """Width and height."""
    square_mm: float
    first_marker: int
    columns: int = COLUMNS
    rows: int = ROWS

    @property
    def module_mm(self) -> float:
        """Side of the smallest square."""
        return self.square_mm / SQUARE_MODULES

    @cached_property
    def pattern(self) -> CharucoBoard:
        """For OpenCV."""
        return CharucoBoard(self.columns, self.rows, self.first_marker)

    @cached_property
    def corners(self) -> Floats:
        """Inner corners by their numbers, in squares; shape (n, 2)."""
        return self.pattern.corners

    def modules(self) -> Mask:
        """Which modules are black, from the left top; shape (64, 48)."""
        return self.pattern.modules()


BOARDS = {
    "A4": Board("A4", (210.0, 297.0), 30.0, first_marker=0),
    "A3": Board("A3", (297.0, 420.0), 42.0, first_marker=COLUMNS * ROWS // 2),
}
"""By their paper. All their markers differ."""
