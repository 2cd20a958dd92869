"""Compiles a C file of this folder into a library or a program, or says why that is not possible."""

import atexit
import ctypes
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parent
COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-O3", "-march=native", "-std=gnu11", "-Wall")
LIBRARY = ("-shared", "-fPIC")
TIMEOUT_S = 120.0


@cache
def load_library(name: str, *extra: str) -> tuple[ctypes.CDLL | None, str]:
    """Compile ``<name>.c`` and load it. Returns the library and the compiler's command, or None and the reason.

    extra: further flags, for example "-lpthread". The file is removed at once; the loaded library stays. Set
    ``argtypes`` and ``restype`` of a function before calling it; pass an array as ``c_void_p(array.ctypes.data)``.
    """
    with tempfile.TemporaryDirectory(prefix="pslv-baseline-") as folder:
        library = Path(folder) / f"{name}.so"
        built, message = _compile(name, library, (*LIBRARY, *extra))
        return (ctypes.CDLL(str(library)) if built else None), message


@cache
def build_program(name: str, *extra: str) -> tuple[Path | None, str]:
    """Compile ``<name>.c`` into a program. Returns its path and the compiler's command, or None and the reason.

    extra: further flags. The program is removed when this process ends.
    """
    folder = Path(tempfile.mkdtemp(prefix="pslv-baseline-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    program = folder / name
    built, message = _compile(name, program, extra)
    return (program if built else None), message


def _compile(name: str, target: Path, extra: tuple[str, ...]) -> tuple[bool, str]:
    """Compile ``<name>.c``. Returns whether that succeeded, and the compiler's command or the reason."""
    compiler = next((path for word in COMPILERS if (path := shutil.which(word))), None)
    if compiler is None:
        return False, f"baselines in C are left out: no C compiler was found ({', '.join(COMPILERS)})"
    flags = [*FLAGS, *extra]
    command = [compiler, *FLAGS, str(FOLDER / f"{name}.c"), "-o", str(target), "-lm", *extra]
    try:
        built = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired:
        return False, f"{name}.c is left out: the compiler took more than {TIMEOUT_S:.0f} s"
    if built.returncode:
        return False, f"{name}.c does not compile: {built.stderr.strip()[:200]}"
    return True, " ".join([Path(compiler).name, *flags])
