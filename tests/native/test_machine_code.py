"""Only what Python calls has machine code, and it holds what it calls."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from vision_core.native import kernel_cache
from vision_core.native.kernel_folder import kernel_files, machine_code
from vision_core.native.kernels import kernel
from vision_core.native.private_folder import PrivateFolder

ELF = b"\x7fELF"


def kernels() -> tuple[Any, Any]:
    """A kernel and one that calls it, as a new process has them."""

    @kernel
    def half(x: float) -> float:
        return x / 2.0

    @kernel
    def quarter(x: float) -> float:
        return half(half(x))

    return half, quarter


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[PrivateFolder]:
    opened = PrivateFolder.open(tmp_path / "jit", follow_link=False)
    monkeypatch.setattr(kernel_cache, "_folder", lambda: opened)
    yield opened
    opened.close()


def with_machine_code(folder: PrivateFolder) -> dict[str, bool]:
    """Of every file: does it hold machine code? By variant and name."""
    contents = {name: folder.read(name) or b"" for name in kernel_files(folder)}
    return {name.rpartition("-")[0].rpartition(".")[2]: ELF in machine_code(data) for name, data in contents.items()}


def test_what_only_kernels_call_has_none(folder: PrivateFolder) -> None:
    assert kernels()[1](8.0) == 2.0
    assert with_machine_code(folder) == {"half-nested": False, "quarter-called": True}


def test_a_caller_is_compiled_with_what_is_on_disk(folder: PrivateFolder) -> None:
    kernels()[1](8.0)
    (caller,) = (name for name in kernel_files(folder) if "quarter" in name)
    folder.delete(caller)
    half, quarter = kernels()
    assert quarter(8.0) == 2.0
    assert kernels()[1](8.0) == 2.0
    assert half(8.0) == 4.0
    assert with_machine_code(folder) == {"half-called": True, "half-nested": False, "quarter-called": True}
