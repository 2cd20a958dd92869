"""Kernels on disk: found again, and compiled again when a file cannot be used."""

import errno
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vision_core.native import kernel_cache
from vision_core.native.kernel_folder import compiled_kernels, kernel_files
from vision_core.native.kernels import box, compile_for_kernels, field_type, kernel, read_only
from vision_core.native.private_folder import PrivateFolder


def twice(x: int) -> int:
    return 2 * x


def fresh_kernel() -> Any:
    """A kernel as a new process has it: with nothing loaded yet."""
    return kernel(twice)


def hits(compiled: Any) -> int:
    return int(sum(compiled.stats.cache_hits.values()))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[PrivateFolder]:
    opened = PrivateFolder.open(tmp_path / "jit", follow_link=False)
    monkeypatch.setattr(kernel_cache, "_folder", lambda: opened)
    kernel_cache._log_once.cache_clear()
    yield opened
    opened.close()


def test_a_kernel_is_compiled_once(folder: PrivateFolder) -> None:
    assert fresh_kernel()(21) == 42
    (name,) = kernel_files(folder)
    (compiled,) = compiled_kernels(folder, [name])
    assert (compiled.kernel, compiled.signature) == (f"{__name__}.twice", "(int64,)")
    assert compiled.seconds > 0.0
    again = fresh_kernel()
    assert again(21) == 42
    assert hits(again) == 1


@pytest.mark.parametrize(
    "damage", [lambda data: data[: len(data) // 2], lambda _: b"", lambda data: b"\x80" * len(data)]
)
def test_a_damaged_file_is_compiled_again(
    folder: PrivateFolder, capfd: pytest.CaptureFixture[str], damage: Any
) -> None:
    fresh_kernel()(21)
    fresh_kernel()(21.0)
    written = {name: folder.read(name) for name in kernel_files(folder)}
    for name in written:
        (folder.path / name).write_bytes(damage((folder.path / name).read_bytes()))
    again = fresh_kernel()
    assert (again(21), again(21.5), hits(again)) == (42, 43.0, 0)
    assert (
        capfd.readouterr().err == f"pslv: {folder.path}: damaged files are deleted, and their kernels compiled again\n"
    )
    assert kernel_files(folder) == list(written)
    final = fresh_kernel()
    assert (final(21), final(21.5), hits(final)) == (42, 43.0, 2)


def test_a_file_of_something_else_is_compiled_again(folder: PrivateFolder, capfd: pytest.CaptureFixture[str]) -> None:
    fresh_kernel()(21)
    (name,) = kernel_files(folder)
    folder.write(name, b"{}\nno machine code")
    assert fresh_kernel()(21) == 42
    assert capfd.readouterr().err.count("\n") == 1


def test_a_full_disk_is_said_once(
    folder: PrivateFolder, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def full(_self: PrivateFolder, _name: str, _content: bytes) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(PrivateFolder, "write", full)
    compiled = fresh_kernel()
    assert (compiled(21), compiled(21.5)) == (42, 43.0)
    said = capfd.readouterr().err
    assert said.startswith(f"pslv: {folder.path}: No space left on device")
    assert said.count("\n") == 1


def test_without_a_folder_kernels_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_cache, "_folder", lambda: None)
    assert fresh_kernel()(21) == 42
    assert fresh_kernel().stats.cache_path is None


def test_a_constant_argument_compiles_nothing_new(folder: PrivateFolder) -> None:
    inner = fresh_kernel()

    def sums(x: int) -> int:
        return int(inner(1) + inner(2) + inner(x))

    assert kernel(sums)(3) == 12
    kernels = sorted(kernel.signature for kernel in compiled_kernels(folder, kernel_files(folder)))
    assert kernels == ["(int64,)", "(int64,)"], "one for sums, one for all three calls"


def test_what_kernels_call_can_be_compiled_before_they_are(folder: PrivateFolder) -> None:
    def first(rows: Any) -> int:
        return int(rows[0])

    table = np.zeros(1, dtype=[("rows", np.int64, (3,))])
    compile_for_kernels(kernel(first), field_type(table, "rows"))
    inner = kernel(first)

    def outer(whole: Any) -> int:
        return inner(whole[0].rows)

    before = kernel_files(folder)
    assert kernel(outer)(table) == 0
    assert len(kernel_files(folder)) == len(before) + 1


def test_flush_forgets_a_kernel_on_disk(folder: PrivateFolder) -> None:
    compiled = fresh_kernel()
    compiled(21)
    compiled._cache.flush()
    assert kernel_files(folder) == []


def test_a_box_holds_the_very_arrays() -> None:
    def total(boxed: Any) -> float:
        return float(boxed.value[0].sum())

    array = np.ones(3)
    boxed = box((array, np.zeros(1)))
    compiled = kernel(total)
    assert compiled(boxed) == 3.0
    array[0] = 5.0
    assert compiled(boxed) == 7.0


def test_read_only_is_one_layout() -> None:
    array = np.zeros((4, 6))
    views = [read_only(view) for view in (array, array.T, array[::2])]
    assert not any(view.flags.writeable for view in views)
    assert all(view.flags.c_contiguous for view in views)
