"""Machine code of only those kernels that Python calls, in place of numba's libraries.

numba optimizes every kernel and makes machine code of it, together with all kernels that it calls, although a kernel
that others call is built into each of them and is optimized there once more. Here a library is optimized and made into
machine code when the address of one of its functions is asked for: only Python asks. What other kernels call stays
intermediate code ("bitcode") in memory and on disk. This takes a fifth off the time for compiling.
"""

from typing import Any

from numba.core import codegen as _codegen_of_numba

numba_codegen: Any = _codegen_of_numba

OBJECT = "machine code"
"""Kind of a library on disk, beside those of numba."""
ROUNDS = 2
"""How often all is optimized together: one round leaves the frame path 3 % slower than numba's round for every kernel,
two leave it as fast (docs/decisions/0020)."""


class LazyLibrary(numba_codegen.JITCodeLibrary):  # type: ignore[misc]
    """What one function was compiled to, with all that it calls."""

    _is_made = False
    """Is there machine code?"""

    def get_pointer_to_function(self, name: str) -> int:
        """Address of a function; 0 where the library has none of this name."""
        self._ensure_finalized()
        if not self._is_made and self._defines(name):
            self._make()
        address: int = super().get_pointer_to_function(name)
        return address

    def serialize_using_object_code(self) -> tuple[str, str, Any]:
        """The library for the disk: its machine code and the names in it, or without that its bitcode."""
        self._ensure_finalized()
        if not self._is_made:
            return self.serialize_using_bitcode()  # type: ignore[no-any-return]
        items = (*self._final_module.functions, *self._final_module.global_variables)
        return (
            self.name,
            OBJECT,
            (self._get_compiled_object(), [item.name for item in items if not item.is_declaration]),
        )

    @classmethod
    def _unserialize(cls, codegen: Any, state: tuple[str, str, Any]) -> Any:
        name, kind, content = state
        if kind != OBJECT:
            return super()._unserialize(codegen, state)
        library = codegen.create_library(name)
        machine_code, names = content
        library.enable_object_caching()
        library._set_compiled_object(machine_code)
        library._is_made = True
        codegen._engine._defined_symbols.update(names)
        super(LazyLibrary, library)._finalize_final_module()
        return library

    def _optimize_final_module(self) -> None:
        """What numba does when all is linked; here it waits until there shall be machine code."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def _defines(self, name: str) -> bool:
        return any(function.name == name and not function.is_declaration for function in self._final_module.functions)

    def _make(self) -> None:
        self._is_made = True
        for _ in range(ROUNDS):
            super()._optimize_final_module()
        self._final_module.verify()
        super()._finalize_final_module()


class _Codegen(numba_codegen.JITCPUCodegen):  # type: ignore[misc]
    """numba's way from intermediate to machine code, with these libraries."""

    _library_class = LazyLibrary

    def set_env(self, env_name: str, env: Any) -> None:
        """Give a function the objects that it uses; one without machine code is given them with its caller."""
        if self._engine.is_symbol_defined(env_name):
            super().set_env(env_name, env)


def use_lazy_libraries() -> None:
    """Let numba compile this way from now on; to be called before the first function is compiled."""
    numba_codegen.JITCPUCodegen = _Codegen
