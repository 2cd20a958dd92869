"""Where state and compiled kernels lie on disk.

Kernels lie in ``PSLV_DATA_DIR/jit/<hash>``, where the hash covers the source of every kernel, numba's
version and the processor: numba itself does not notice an edited callee in another file, and a cache
from another machine may hold instructions that this one lacks.
"""

import hashlib
import os
import platform
from importlib.metadata import version
from pathlib import Path

PACKAGE = Path(__file__).parents[1]


def data_folder() -> Path:
    """Where the service keeps its state: ``PSLV_DATA_DIR``, or the platform's user data folder."""
    if chosen := os.environ.get("PSLV_DATA_DIR"):
        return Path(chosen).expanduser().absolute()
    from platformdirs import user_data_path

    return user_data_path("pslv", appauthor=False)


def kernel_folder() -> Path:
    """The folder of compiled kernels of this code on this machine."""
    return data_folder() / "jit" / kernel_fingerprint()


def kernel_fingerprint() -> str:
    """Hash of every kernel source, Python, numba and the processor; 16 hex digits."""
    digest = hashlib.sha256()
    for source in sorted(PACKAGE.rglob("*.py")):
        text = source.read_bytes()
        if b"@kernel" in text:
            digest.update(source.relative_to(PACKAGE).as_posix().encode())
            digest.update(text)
    for part in (version("numba"), platform.python_version(), _processor()):
        digest.update(part.encode())
    return digest.hexdigest()[:16]


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return "\n".join(line for line in lines[:40] if line.startswith(("model name", "flags", "CPU part")))
