"""One door to numba: ``@kernel`` compiles a function without the interpreter and caches it on disk.

numba reads the cache's place when it is imported, so this is the only module that imports it; what else is needed
of it has a name here: ``intrinsic`` makes a function of instructions that Python has no word for.
"""

import os
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

import numpy as np

from vision_core.geometry import Array
from vision_core.native.kernel_cache import kernel_folder

P = ParamSpec("P")
R = TypeVar("R")

os.environ.setdefault("NUMBA_CACHE_DIR", str(kernel_folder()))
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numba  # noqa: E402
from numba import extending  # noqa: E402
from numba.experimental import structref as _structref  # noqa: E402

machine_types: Any = numba.types
structref: Any = _structref


def intrinsic(function: Callable[..., Any]) -> Callable[..., Any]:
    """Make a function for use inside kernels out of code that writes its instructions."""
    made: Callable[..., Any] = extending.intrinsic(function)
    return made


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function for the hot path: no Python objects inside, cached on disk."""
    compiled: Any = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return compiled  # type: ignore[no-any-return]


@structref.register
class _KeptType(numba.types.StructRef):
    """What kernels see of ``Kept``."""


class Kept(structref.StructRefProxy):  # type: ignore[misc]
    """Arguments that stay the same from call to call, taken apart once by ``keep``.

    A tuple of many arrays costs a fifth of a microsecond per array at every call; this costs as much as one of them.
    Kernels read it as ``value``; it holds the very arrays, not copies.
    """

    value: Any


structref.define_proxy(Kept, _KeptType, ["value"])


@kernel
def keep(value: Any) -> Kept:
    """Take a tuple of arrays apart for all calls to come."""
    return Kept(value)


def read_only(array: Array) -> Array:
    """One memory layout for a kernel, which is compiled anew for every other: frames come read-only or not."""
    view = np.ascontiguousarray(array).view()
    view.setflags(write=False)
    return cast("Array", view)


def external(name: str, signature: str) -> Any:
    """A function of the C library for use in kernels. signature: "int32(int32, uintp)", addresses as uintp."""
    normalize: Any = numba.core.sigutils.normalize_signature
    arguments, result = normalize(signature)
    return numba.types.ExternalFunction(name, result(*arguments))


carray: Any = getattr(numba, "carray")  # noqa: B009 (numba does not say that it exports it)
"""An array over memory whose address the C library told."""
