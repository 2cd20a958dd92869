"""Instructions that Python has no word for, for use inside a ``@kernel``: 64 pixels at once.

A compiler turns a loop over bytes into wide instructions only while the values stay bytes, and numba makes them words
as soon as they are added. So the wide part is written directly in LLVM's instructions, on vectors of 64 bytes, which
every processor has as one register or as several. Indices are not checked here: callers stay inside their arrays.
"""

from functools import reduce
from typing import Any

from llvmlite import ir

from vision_core.native.kernels import intrinsic, machine_types
from vision_core.types.colors import CELL_BITS_BGR
from vision_core.types.prefilter import CONDITIONS

LANES = 64
"""Pixels that one instruction takes."""
CHAINS = 4
"""Reads that do not wait for each other."""
BYTE, WORD, LONG = ir.IntType(8), ir.IntType(32), ir.IntType(64)
BYTES, SHORTS = ir.VectorType(BYTE, LANES), ir.VectorType(ir.IntType(16), LANES)


@intrinsic
def prefilter_mask(_typing: Any, flat: Any, pixel: Any, limits: Any) -> Any:
    """Which of 64 pixels pass a ``ColorPrefilter``, as bits, the first pixel's lowest.

    (flat, pixel, limits): flat uint8 (pixels * 3,), blue green red; number of the first pixel; 16 bytes, the
    prefilter's margin limits and then its level limits.
    """

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, values[0]).data
        given = [_broadcast(builder, builder.extract_value(values[2], number)) for number in range(2 * CONDITIONS)]
        channels = _channels(builder, data, values[1])
        passed = _passed(builder, channels, given[:CONDITIONS], given[CONDITIONS:])
        return builder.bitcast(builder.icmp_unsigned("!=", passed, ir.Constant(BYTES, None)), LONG)

    return machine_types.uint64(flat, pixel, limits), code


@intrinsic
def write_cells(_typing: Any, flat: Any, pixel: Any, cells: Any, place: Any) -> Any:
    """Write the color cells of 64 pixels: (flat, pixel, cells, place).

    cells: uint16, filled from ``place`` on.
    """

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data, out = (context.make_array(signature.args[k])(context, builder, values[k]).data for k in (0, 2))
        cell = ir.Constant(SHORTS, None)
        for channel, (drop, bit) in zip(_channels(builder, data, values[1]), CELL_BITS_BGR, strict=True):
            level = builder.lshr(builder.zext(channel, SHORTS), ir.Constant(SHORTS, [drop] * LANES))
            cell = builder.or_(cell, builder.shl(level, ir.Constant(SHORTS, [bit] * LANES)))
        builder.store(cell, builder.bitcast(builder.gep(out, [values[3]]), SHORTS.as_pointer()), align=2)
        return context.get_dummy_value()

    return machine_types.void(flat, pixel, cells, place), code


@intrinsic
def any_class(_typing: Any, cells: Any, place: Any, classes: Any) -> Any:
    """0 if none of the 64 cells from ``place`` on has a class: (cells, place, classes), without a branch in between."""

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data, table = (context.make_array(signature.args[k])(context, builder, values[k]).data for k in (0, 2))
        found = [ir.Constant(BYTE, 0)] * CHAINS
        for lane in range(LANES):
            at = builder.gep(data, [builder.add(values[1], ir.Constant(LONG, lane))])
            number = builder.zext(builder.load(at), LONG)
            found[lane % CHAINS] = builder.or_(found[lane % CHAINS], builder.load(builder.gep(table, [number])))
        return reduce(builder.or_, found)

    return machine_types.uint8(cells, place, classes), code


def _external(builder: Any, name: str, kind: Any) -> Any:
    """An intrinsic function of LLVM, declared once per module."""
    known = builder.module.globals
    return known[name] if name in known else ir.Function(builder.module, kind, name)


def _wide(builder: Any, name: str, one: Any, two: Any) -> Any:
    """A two-operand instruction on 64 bytes."""
    return builder.call(
        _external(builder, f"llvm.{name}.v{LANES}i8", ir.FunctionType(BYTES, [BYTES, BYTES])), [one, two]
    )


def _channels(builder: Any, data: Any, pixel: Any) -> list[Any]:
    """64 pixels of three bytes each, separated into one vector per channel."""
    start = builder.mul(pixel, ir.Constant(LONG, 3))
    thirds = []
    for third in range(3):
        at = builder.gep(data, [builder.add(start, ir.Constant(LONG, third * LANES))])
        thirds.append(builder.load(builder.bitcast(at, BYTES.as_pointer()), align=1))
    channels = []
    for channel in range(3):
        places = [3 * lane + channel for lane in range(LANES)]
        front = [place if place < 2 * LANES else 0 for place in places]
        back = [lane if place < 2 * LANES else place - LANES for lane, place in enumerate(places)]
        picked = builder.shuffle_vector(thirds[0], thirds[1], _lane_indices(front))
        channels.append(builder.shuffle_vector(picked, thirds[2], _lane_indices(back)))
    return channels


def _lane_indices(places: list[int]) -> Any:
    """The lane indices of a vector shuffle, as a constant of LLVM."""
    return ir.Constant(ir.VectorType(WORD, LANES), places)


def _passed(builder: Any, channels: list[Any], margins: list[Any], levels: list[Any]) -> Any:
    """Bytes that are 0 where a pixel meets none of the conditions of ``ColorPrefilter``."""

    def excess(one: Any, two: Any) -> Any:
        """one - two, 0 where it would be negative."""
        return _wide(builder, "usub.sat", one, two)

    passed = ir.Constant(BYTES, None)
    for condition, channel in enumerate(channels):
        # conditions 0..2: the channel stands out; 3..5: it falls behind
        others = channels[(condition + 1) % 3], channels[(condition + 2) % 3]
        largest, smallest = (_wide(builder, name, *others) for name in ("umax", "umin"))
        for number, high, low in ((condition, channel, largest), (condition + 3, smallest, channel)):
            margin, level = excess(excess(high, low), margins[number]), excess(high, levels[number])
            passed = builder.or_(passed, _wide(builder, "umin", margin, level))
    # condition 6: light, condition 7: dark
    darkest = _wide(builder, "umin", smallest, channels[2])
    lightest = _wide(builder, "umax", largest, channels[2])
    passed = builder.or_(passed, excess(darkest, levels[6]))
    return builder.or_(passed, excess(levels[7], lightest))


def _broadcast(builder: Any, value: Any) -> Any:
    """One byte in all lanes."""
    undefined = ir.Constant(BYTES, ir.Undefined)
    first = builder.insert_element(undefined, value, ir.Constant(WORD, 0))
    return builder.shuffle_vector(first, undefined, _lane_indices([0] * LANES))
