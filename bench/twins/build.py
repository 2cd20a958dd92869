"""One C file of this folder -> a library that is loaded, or a word why there is none."""

import ctypes
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parent
COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-O3", "-march=native", "-std=gnu11", "-Wall", "-shared", "-fPIC")
TIMEOUT_S = 120.0


@cache
def load_twin(name: str, *extra: str) -> tuple[ctypes.CDLL | None, str]:
    """Compile ``<name>.c`` and load it: the library and the compiler's call, or None and the reason.

    extra: further flags, for example "-lpthread". What is built lies in a temporary folder that is removed at once; the
    loaded stays loaded. Set ``argtypes`` and ``restype`` of a function before calling it; arrays go in as
    ``c_void_p(array.ctypes.data)``.
    """
    compiler = next((path for word in COMPILERS if (path := shutil.which(word))), None)
    if compiler is None:
        return None, f"no C compiler ({', '.join(COMPILERS)}): twins skipped"
    with tempfile.TemporaryDirectory(prefix="pslv-twin-") as folder:
        library = Path(folder) / f"{name}.so"
        command = [compiler, *FLAGS, str(FOLDER / f"{name}.c"), "-o", str(library), "-lm", *extra]
        try:
            built = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        except subprocess.TimeoutExpired:
            return None, f"{name}.c: the compiler took over {TIMEOUT_S:.0f} s: twin skipped"
        if built.returncode:
            return None, f"{name}.c does not compile: {built.stderr.strip()[:500]}"
        return ctypes.CDLL(str(library)), " ".join([Path(compiler).name, *FLAGS])
