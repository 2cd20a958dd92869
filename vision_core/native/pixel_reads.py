"""Reading pixels as no Python expression does, for use inside a ``@kernel``: several bytes at once, and beforehand.

Indices are not checked here: callers stay inside their arrays.
"""

from typing import Any

from llvmlite import ir

from vision_core.native.kernels import intrinsic, machine_types

BYTE, WORD, LONG, VOID = ir.IntType(8), ir.IntType(32), ir.IntType(64), ir.VoidType()


@intrinsic
def word_at(_typing: Any, flat: Any, pixel: Any) -> Any:
    """A pixel and one byte more in one read: (flat, pixel) -> blue | green << 8 | red << 16 | any << 24, uint32.

    Not for the last pixel of a picture.
    """

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        at = _address(context, builder, signature, values)
        return builder.load(builder.bitcast(at, WORD.as_pointer()), align=1)

    return machine_types.uint32(flat, pixel), code


@intrinsic
def prefetch(_typing: Any, flat: Any, pixel: Any) -> Any:
    """Load the memory of a pixel that is needed soon into the cache: (flat, pixel). May lie outside of the picture."""

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind = ir.FunctionType(VOID, [BYTE.as_pointer(), WORD, WORD, WORD])
        fetch = builder.module.globals.get("llvm.prefetch.p0") or ir.Function(builder.module, kind, "llvm.prefetch.p0")
        at = _address(context, builder, signature, values)
        builder.call(fetch, [at, *(ir.Constant(WORD, how) for how in (0, 3, 1))])  # to read, to keep, data
        return context.get_dummy_value()

    return machine_types.void(flat, pixel), code


def _address(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """Of a pixel: values are the picture's bytes, blue green red, and the pixel's number."""
    data = context.make_array(signature.args[0])(context, builder, values[0]).data
    return builder.gep(data, [builder.mul(values[1], ir.Constant(LONG, 3))])
