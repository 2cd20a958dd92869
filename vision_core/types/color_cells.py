"""The color cell of a pixel, inside compiled kernels. ``types.colors`` has the same for arrays, and without numba."""

import numpy as np

from vision_core.native.kernels import kernel
from vision_core.types.colors import cell_index

_cell_index = kernel(cell_index)


@kernel
def color_cell(blue: int, green: int, red: int) -> int:
    """Index of a color in the color table, 0..65535, from three levels 0..255 of any integer type."""
    index: int = _cell_index(np.intp(blue), np.intp(green), np.intp(red))
    return index
