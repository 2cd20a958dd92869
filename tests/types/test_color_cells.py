"""The color cell in compiled kernels is that of the color table, for every integer type that pixels have."""

import numpy as np

from vision_core.types.color_cells import color_cell
from vision_core.types.colors import CELL_BITS_BGR, CELL_COUNT, CELL_SIZE_BGR, cell_corner, cell_index


def test_kernels_and_arrays_agree() -> None:
    colors = np.random.default_rng(1).integers(0, 256, (200, 3), dtype=np.uint8)
    index = cell_index(*colors.astype(np.intp).T)
    assert [color_cell(*color) for color in colors] == index.tolist()


def test_a_cell_begins_at_its_corner_and_holds_its_size() -> None:
    cells = np.arange(CELL_COUNT)
    low = np.column_stack(cell_corner(cells))
    high = low + np.array(CELL_SIZE_BGR) - 1
    assert (cell_index(*low.T) == cells).all()
    assert (cell_index(*high.T) == cells).all()
    assert high.max(axis=0).tolist() == [255, 255, 255]


def test_the_size_follows_from_the_dropped_bits() -> None:
    assert tuple(1 << drop for drop, _ in CELL_BITS_BGR) == CELL_SIZE_BGR
