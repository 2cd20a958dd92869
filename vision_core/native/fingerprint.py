"""Which code compiled kernels belong to.

Constants, dtypes and callees from other files are compiled into a kernel, and numba notices a change only in the
kernel's own file. So the fingerprint covers every source file of the package. It covers the code alone: comments,
docstrings and layout do not count, so that editing them compiles nothing anew.
"""

import ast
import hashlib
import os
import platform
from collections.abc import MutableMapping
from importlib.metadata import version
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
DIGITS = 16
LIBRARIES = ("numba", "llvmlite", "numpy")
NO_EFFECT = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS")
"""Variables of numba that do not change what it compiles."""


def kernel_fingerprint(code_hashes: MutableMapping[str, str], package: Path = PACKAGE) -> str:
    """Hash of a package's place and code, of Python, numba, numba's options and the processor; 16 hex digits.

    code_hashes: what is known from earlier calls, the hash of a file's code by the hash of its bytes; files that are
    missing in it are parsed, about 5 ms each. Afterwards it holds the package's files and no other.
    """
    digest, used = hashlib.sha256(str(package).encode()), {}
    for source in sorted(package.rglob("*.py")):
        text = source.read_bytes()
        key = hashlib.sha256(text).hexdigest()
        used[key] = code_hashes.get(key) or _code_hash(text)
        digest.update(f"\n{source.relative_to(package).as_posix()} {used[key]}".encode())
    code_hashes.clear()
    code_hashes.update(used)
    options = [f"{name}={value}" for name, value in sorted(os.environ.items()) if name.startswith("NUMBA_")]
    for part in (
        platform.python_version(),
        *(version(library) for library in LIBRARIES),
        *(option for option in options if not option.startswith(NO_EFFECT)),
        _processor(),
    ):
        digest.update(f"\n{part}".encode())
    return digest.hexdigest()[:DIGITS]


def _code_hash(text: bytes) -> str:
    """Hash of what a source file does: its syntax tree without docstrings and positions."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [statement for statement in body if not _is_text(statement)]  # type: ignore[attr-defined]
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()


def _is_text(statement: ast.stmt) -> bool:
    """Is it a docstring, of a function or of the name before it?"""
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    )


def _processor() -> str:
    """Model and instruction sets of the processor: kernels of another one may hold instructions that this one lacks."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return "\n".join(line for line in lines[:40] if line.startswith(("model name", "flags", "CPU part")))
