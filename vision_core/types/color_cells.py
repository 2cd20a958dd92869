"""Color cell and class of a pixel, inside compiled kernels. ``types.colors`` has the same for arrays, without numba."""

from typing import Any

import numpy as np
from llvmlite import ir

from vision_core.native.kernels import intrinsic, kernel, machine_types
from vision_core.types.colors import CELL_BITS_BGR, cell_index

_cell_index = kernel(cell_index)
LONG = ir.IntType(64)


@kernel
def color_cell(blue: int, green: int, red: int) -> int:
    """Index of a color in the color table, 0..65535, from three levels 0..255 of any integer type."""
    index: int = _cell_index(np.intp(blue), np.intp(green), np.intp(red))
    return index


@intrinsic
def class_at(_typing: Any, flat: Any, pixel: Any, classes: Any) -> Any:
    """The class of one pixel: (flat, pixel, classes), classes uint8 (65536,)."""

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data, table = (context.make_array(signature.args[k])(context, builder, values[k]).data for k in (0, 2))
        start = builder.mul(values[1], ir.Constant(LONG, 3))
        cell = ir.Constant(LONG, 0)
        for channel, (drop, bit) in enumerate(CELL_BITS_BGR):
            at = builder.gep(data, [builder.add(start, ir.Constant(LONG, channel))])
            level = builder.lshr(builder.zext(builder.load(at), LONG), ir.Constant(LONG, drop))
            cell = builder.or_(cell, builder.shl(level, ir.Constant(LONG, bit)))
        return builder.load(builder.gep(table, [cell]))

    return machine_types.uint8(flat, pixel, classes), code
