"""One C file of this folder -> a library that is loaded or a program that can be run, or a word why there is none."""

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
def load_twin(name: str, *extra: str) -> tuple[ctypes.CDLL | None, str]:
    """Compile ``<name>.c`` and load it: the library and the compiler's call, or None and the reason.

    extra: further flags, for example "-lpthread". What is built lies in a temporary folder that is removed at once; the
    loaded stays loaded. Set ``argtypes`` and ``restype`` of a function before calling it; arrays go in as
    ``c_void_p(array.ctypes.data)``.
    """
    with tempfile.TemporaryDirectory(prefix="pslv-twin-") as folder:
        library = Path(folder) / f"{name}.so"
        built, word = _compile(name, library, (*LIBRARY, *extra))
        return (ctypes.CDLL(str(library)) if built else None), word


@cache
def build_program(name: str, *extra: str) -> tuple[Path | None, str]:
    """Compile ``<name>.c`` into a program: its path and the compiler's call, or None and the reason.

    extra: further flags. The program lies in a temporary folder that is removed when this process ends.
    """
    folder = Path(tempfile.mkdtemp(prefix="pslv-twin-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    program = folder / name
    built, word = _compile(name, program, extra)
    return (program if built else None), word


def _compile(name: str, target: Path, extra: tuple[str, ...]) -> tuple[bool, str]:
    """Is the target built? And the compiler's call, or the reason."""
    compiler = next((path for word in COMPILERS if (path := shutil.which(word))), None)
    if compiler is None:
        return False, f"no C compiler ({', '.join(COMPILERS)}): twins skipped"
    flags = [*FLAGS, *extra]
    command = [compiler, *FLAGS, str(FOLDER / f"{name}.c"), "-o", str(target), "-lm", *extra]
    try:
        built = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired:
        return False, f"{name}.c: the compiler took over {TIMEOUT_S:.0f} s: twin skipped"
    if built.returncode:
        return False, f"{name}.c does not compile: {built.stderr.strip()[:500]}"
    return True, " ".join([Path(compiler).name, *flags])
