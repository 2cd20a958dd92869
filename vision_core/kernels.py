"""One door to numba: ``@kernel`` compiles a function without the interpreter and caches it on disk.

The cache lies in ``PSLV_DATA_DIR/jit/<hash>``, where the hash covers the source of every kernel,
numba's version and the processor: numba itself does not notice an edited callee in another file
(and a cache copied from another machine may hold instructions that this one lacks). So this module
must be imported before numba, and it is the only one that imports numba at all.
"""

import hashlib
import os
import platform
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

PACKAGE = Path(__file__).parent


def data_folder() -> Path:
    """Where the service keeps its state: ``PSLV_DATA_DIR``, or the platform's user data folder."""
    if chosen := os.environ.get("PSLV_DATA_DIR"):
        return Path(chosen).expanduser().absolute()
    from platformdirs import user_data_path

    return user_data_path("pslv", appauthor=False)


def kernel_fingerprint() -> str:
    """Hash of every kernel source, numba's version and the processor; 16 hex digits."""
    digest = hashlib.sha256()
    for source in sorted(PACKAGE.rglob("*.py")):
        text = source.read_bytes()
        if b"@kernel" in text:
            digest.update(source.relative_to(PACKAGE).as_posix().encode())
            digest.update(text)
    digest.update(version("numba").encode())
    digest.update(platform.python_version().encode())
    digest.update(_processor().encode())
    return digest.hexdigest()[:16]


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return "\n".join(line for line in lines[:40] if line.startswith(("model name", "flags", "CPU part")))


def kernel_folder() -> Path:
    """The folder of compiled kernels of this code on this machine."""
    return data_folder() / "jit" / kernel_fingerprint()


os.environ.setdefault("NUMBA_CACHE_DIR", str(kernel_folder()))
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numba  # noqa: E402


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function for the hot path: no Python objects inside, cached on disk."""
    compiled: Any = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return compiled  # type: ignore[no-any-return]
