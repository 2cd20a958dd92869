"""A change of code that is compiled into kernels changes the fingerprint; a change of words does not."""

import shutil
from pathlib import Path

import pytest

from vision_core.native.fingerprint import PACKAGE, kernel_fingerprint

CONSTANTS = [
    ("objects/robots/buffers.py", "GRID_CELLS = 64", "GRID_CELLS = 32"),
    ("types/tables.py", "MAX_NUMBERS = 16", "MAX_NUMBERS = 17"),
    ("models/mirror.py", "**2", "**3"),
    ("protocol/see.py", "return", "yield"),
]
"""In files without a kernel; compiled into kernels of other files."""
PARSED: dict[str, str] = {}
"""Hashes of files that a test of this module has parsed."""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package with two modules."""
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "constants.py").write_text('"""Words."""\n\nROOM = 64\n"""More words."""\n')
    (tmp_path / "kernels.py").write_text("# remark\ndef twice(x):\n    return 2 * x\n")
    return tmp_path


@pytest.mark.parametrize(("file", "before", "after"), CONSTANTS, ids=[file for file, _, _ in CONSTANTS])
def test_a_constant_in_a_file_without_kernels_changes_the_fingerprint(
    tmp_path: Path, file: str, before: str, after: str
) -> None:
    copy = tmp_path / "vision_core"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    original = kernel_fingerprint(PARSED, copy)
    source = (copy / file).read_text()
    assert "@kernel" not in source
    assert before in source
    (copy / file).write_text(source.replace(before, after, 1))
    assert kernel_fingerprint(dict(PARSED), copy) != original


def test_comments_and_layout_do_not_change_the_fingerprint(package: Path) -> None:
    original = kernel_fingerprint({}, package)
    (package / "part" / "constants.py").write_text(
        '"""Other words."""\nROOM = (\n    64\n)  # a remark\n"""And others."""\n'
    )
    (package / "kernels.py").write_text('def twice(x):\n    """Twice as much."""\n\n    return 2 * x\n')
    assert kernel_fingerprint({}, package) == original


@pytest.mark.parametrize("text", ["ROOM = 32\n", "", 'ROOM = "64"\n', "ROOM = 64\nROOM\n"])
def test_code_changes_the_fingerprint(package: Path, text: str) -> None:
    original = kernel_fingerprint({}, package)
    (package / "part" / "constants.py").write_text(text)
    assert kernel_fingerprint({}, package) != original


def test_a_moved_file_changes_the_fingerprint(package: Path) -> None:
    original = kernel_fingerprint({}, package)
    (package / "kernels.py").rename(package / "part" / "kernels.py")
    assert kernel_fingerprint({}, package) != original


def test_two_checkouts_have_different_fingerprints(package: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    other = tmp_path_factory.mktemp("other") / "package"
    shutil.copytree(package, other)
    assert kernel_fingerprint({}, other) != kernel_fingerprint({}, package)


def test_compiler_options_of_numba_change_the_fingerprint(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    original = kernel_fingerprint({}, package)
    monkeypatch.setenv("NUMBA_NUM_THREADS", "7")
    assert kernel_fingerprint({}, package) == original
    monkeypatch.setenv("NUMBA_BOUNDSCHECK", "1")
    assert kernel_fingerprint({}, package) != original


def test_a_file_is_parsed_once(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known: dict[str, str] = {"0" * 64: "of a file that is gone"}
    original = kernel_fingerprint(known, package)
    assert len(known) == 2
    monkeypatch.setattr("ast.parse", None)
    assert kernel_fingerprint(known, package) == original
