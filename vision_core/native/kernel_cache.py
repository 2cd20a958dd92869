"""Compiled kernels on disk: one file for each kernel and signature, in place of numba's own cache.

numba's cache keeps an index per function, which two processes that compile at the same time overwrite for each other,
and it stops with a traceback at a damaged file or a full disk. Here each kernel has a file of its own with a checksum;
a damaged one is deleted and compiled again, and a kernel that cannot be written is used from memory. One line says so.
"""

import contextlib
import functools
import hashlib
import pickle
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from numba.core import caching, compiler, serialize

from vision_core.native.fingerprint import PACKAGE
from vision_core.native.kernel_folder import DAMAGED, CompiledKernel, choose_kernel_folder, machine_code
from vision_core.native.private_folder import DamagedFileError, PrivateFolder

_encode: Any = serialize.dumps
_rebuild: Any = compiler.CompileResult._rebuild
NAME_CHARACTERS = 80
NOT_IN_NAMES = str.maketrans("", "", "<>/")


@dataclass(slots=True)
class _Compilation:
    """A kernel that is being compiled: its name and signature, when that began, and what its callees took [s]."""

    what: tuple[str, Any]
    began: float
    nested_s: float = 0.0


class KernelCache(caching._Cache):
    """What numba asks before it compiles a kernel, and tells afterwards."""

    _compiling: ClassVar[list[_Compilation]] = []
    """Kernels that are being compiled now: a kernel, then one that it calls, and so on."""

    def __init__(self, function: Callable[..., Any], variant: str) -> None:
        """variant: "called" by Python or "nested" in another kernel; they are compiled apart."""
        self._function = function
        self._name = f"{function.__module__}.{function.__qualname__}"
        self._files = f"{self._name[-NAME_CHARACTERS:].translate(NOT_IN_NAMES)}-{variant}-"

    @property
    def cache_path(self) -> str | None:
        folder = _folder()
        return None if folder is None else str(folder.path)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled kernel for a signature; None: it must be compiled."""
        target_context.refresh()
        found = self._load(sig, target_context)
        if found is None:
            self._compiling.append(_Compilation((self._files, sig), time.process_time()))
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Write a kernel that was just compiled."""
        seconds = self._seconds_of(sig)
        for environment in data._find_referenced_environments():
            data.codegen.set_env(environment.env_name, environment)
        folder = _folder()
        if folder is None:
            return
        if data.library.has_dynamic_globals:
            raise RuntimeError(f"kernel {self._name} uses an array too large to be a constant: pass it as an argument")
        key = self._key(sig, data.codegen)
        kernel = CompiledKernel(self._name, str(sig), seconds)
        try:
            folder.write(self._file_name(key), kernel.encode(_encode((key, data._reduce()))))
        except OSError as error:
            _log_once(f"{folder.path}: {error.strerror}: kernels are compiled in memory, by each process anew")

    def enable(self) -> None:
        """numba's switch for all caches; ours is always on."""

    def disable(self) -> None:
        """numba's switch for all caches; ours is always on."""

    def flush(self) -> None:
        """Forget what is on disk; numba asks for it when a kernel is to be compiled once more."""
        if (folder := _folder()) is not None:
            for name in folder.names():
                if name.startswith(self._files):
                    folder.delete(name)

    def _load(self, sig: Any, target_context: Any) -> Any:
        folder = _folder()
        if folder is None:
            return None
        key = self._key(sig, target_context.codegen())
        name = self._file_name(key)
        try:
            content = folder.read(name)
            if content is None:
                return None
            stored_key, payload = pickle.loads(machine_code(content))  # noqa: S301 (of a folder that only we write)
            if stored_key != key:
                return None
            return _rebuild(target_context, *payload)
        except (DamagedFileError, pickle.UnpicklingError, EOFError, ValueError, TypeError, AttributeError, ImportError):
            folder.delete(name)
            _log_once(DAMAGED.format(folder.path))
            return None

    def _key(self, sig: Any, codegen: Any) -> tuple[Any, ...]:
        """What a kernel was compiled from, beside the code that the folder stands for."""
        closure = self._function.__closure__ or ()
        cells = _encode(tuple(cell.cell_contents for cell in closure)) if closure else b""
        code = hashlib.sha256(self._function.__code__.co_code + cells + self._foreign_source()).hexdigest()
        return sig, codegen.magic_tuple(), code

    def _foreign_source(self) -> bytes:
        """The source file of a kernel outside the package, which the folder's fingerprint does not cover."""
        file = Path(self._function.__code__.co_filename)
        return b"" if file.is_relative_to(PACKAGE) or not file.is_file() else file.read_bytes()

    def _file_name(self, key: tuple[Any, ...]) -> str:
        digest = hashlib.sha256(repr(key).encode()).hexdigest()[:16]
        return self._files + digest

    def _seconds_of(self, sig: Any) -> float:
        """How long a kernel took, without those that it calls; what was given up in between is left out."""
        ended = time.process_time()
        while self._compiling:
            compilation = self._compiling.pop()
            if compilation.what == (self._files, sig):
                total = ended - compilation.began
                if self._compiling:
                    self._compiling[-1].nested_s += total
                return total - compilation.nested_s
        return 0.0


@functools.cache
def _folder() -> PrivateFolder | None:
    """The folder of this process, chosen when the first kernel is loaded or compiled."""
    folder, notice = choose_kernel_folder()
    if notice:
        _log_once(notice)
    return folder


@functools.cache
def _log_once(line: str) -> None:
    with contextlib.suppress(OSError):
        print(f"pslv: {line}", file=sys.stderr, flush=True)
