"""One door to numba: ``@kernel`` compiles a function without the interpreter and caches it on disk.

numba reads the cache's place when it is imported, so this is the only module that imports it.
"""

import os
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from vision_core.kernel_cache import kernel_folder

P = ParamSpec("P")
R = TypeVar("R")

os.environ.setdefault("NUMBA_CACHE_DIR", str(kernel_folder()))
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numba  # noqa: E402


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function for the hot path: no Python objects inside, cached on disk."""
    compiled: Any = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return compiled  # type: ignore[no-any-return]
