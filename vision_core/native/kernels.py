"""One door to numba: ``@kernel`` compiles a function without the interpreter and caches it on disk.

numba reads its options when it is imported, so only this package imports it; what else is needed of it has a name here:
``intrinsic`` makes a function of instructions that Python has no word for.
"""

import os
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

import numpy as np

from vision_core.geometry import Array

P = ParamSpec("P")
R = TypeVar("R")

os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numba  # noqa: E402
from numba import extending  # noqa: E402
from numba.experimental import structref as _structref  # noqa: E402

from vision_core.native.kernel_cache import KernelCache  # noqa: E402
from vision_core.native.machine_code import use_lazy_libraries  # noqa: E402

use_lazy_libraries()

machine_types: Any = numba.types
_compiler: Any = numba.njit
_type_of: Any = numba.typeof
structref: Any = _structref


def intrinsic(function: Callable[..., Any]) -> Callable[..., Any]:
    """Make a function for use inside kernels out of code that writes its instructions."""
    made: Callable[..., Any] = extending.intrinsic(function)
    return made


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function for the hot path: no Python objects inside, cached on disk.

    What Python calls is compiled with the wrapper that takes Python's arguments apart; what other kernels call is
    compiled without one, which takes much less time when the arguments are bundles of arrays. A constant argument is
    a variable of its type to the callee: numba alone would compile the callee anew for every constant.
    """
    called: Any = _compiler(nogil=True, error_model="numpy")(function)
    nested: Any = _compiler(nogil=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)(function)
    called._cache, nested._cache = KernelCache(function, "called"), KernelCache(function, "nested")

    def call_template(arguments: Any, keywords: Any) -> Any:
        plain = {name: machine_types.unliteral(kind) for name, kind in keywords.items()}
        return nested.get_call_template(tuple(machine_types.unliteral(kind) for kind in arguments), plain)

    called.get_call_template = call_template  # numba asks for this when a kernel calls another
    called.get_overload = nested.get_overload
    return called  # type: ignore[no-any-return]


def compile_for_kernels(function: Callable[..., Any], *arguments: Any) -> None:
    """Compile a kernel for those that call it, without calling it. arguments: values, or types of numba."""
    compiled: Any = function
    kinds = (item if isinstance(item, numba.types.Type) else _type_of(item) for item in arguments)
    compiled.get_call_template(tuple(kinds), {})


def field_type(table: Array, field: str) -> Any:
    """What a kernel sees of a field of a row of a table, for ``compile_for_kernels``."""
    return _type_of(table).dtype.typeof(field)


@structref.register
class _BoxedType(numba.types.StructRef):
    """What kernels see of ``Boxed``."""


class Boxed(structref.StructRefProxy):  # type: ignore[misc]
    """Arguments that stay the same from call to call, taken apart once by ``box``.

    A tuple of many arrays costs a fifth of a microsecond per array at every call; this costs as much as one of them.
    Kernels read it as ``value``; it holds the very arrays, not copies.
    """

    value: Any
    kept: Any
    """What ``box`` was given: keeps the arrays alive."""


structref.define_proxy(Boxed, _BoxedType, ["value"])


def box(value: Any) -> Boxed:
    """Take a tuple of arrays apart once, for all calls that follow.

    Kernels do not count references to these arrays: counting is a locked instruction at many a use of an array.
    """
    boxed = _box(value)
    boxed.kept = value
    return boxed


@kernel
def _box(value: Any) -> Boxed:
    return Boxed(_uncounted(value))


@intrinsic
def _uncounted(_typing: Any, value: Any) -> Any:
    """The same tuple, with arrays that have no owner whose references would be counted."""

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _without_owners(context, builder, signature.args[0], values[0])

    return value(value), code


def _without_owners(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """Code for a value of a type of numba: arrays lose their owners, also in tuples; other values count one more."""
    if isinstance(kind, machine_types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = context.get_constant_null(machine_types.MemInfoPointer(machine_types.voidptr))
        array.parent = context.get_constant_null(machine_types.pyobject)
        return array._getvalue()
    if isinstance(kind, machine_types.BaseTuple):
        for place, item in enumerate(kind):
            part = _without_owners(context, builder, item, builder.extract_value(value, place))
            value = builder.insert_value(value, part, place)
        return value
    context.nrt.incref(builder, kind, value)
    return value


def read_only(array: Array) -> Array:
    """The array as C-contiguous and read-only, since a kernel is compiled anew for each memory layout."""
    view = np.ascontiguousarray(array).view()
    view.setflags(write=False)
    return cast("Array", view)


def external(name: str, signature: str) -> Any:
    """A function of the C library for use in kernels. signature: "int32(int32, uintp)", addresses as uintp."""
    normalize: Any = numba.core.sigutils.normalize_signature
    arguments, result = normalize(signature)
    return numba.types.ExternalFunction(name, result(*arguments))


carray: Any = getattr(numba, "carray")  # noqa: B009 (numba does not say that it exports it)
"""An array over memory at an address that the C library returned."""
