"""Steps are compiled in their order by several processes; what is complete is not compiled again."""

from pathlib import Path
from typing import Any

import pytest

from vision_core.errors import ServiceError
from vision_core.native import kernel_folder
from vision_core.native.kernel_folder import VARIABLE, CompiledKernel, choose_kernel_folder, is_complete
from vision_core.pipeline.warm_up import COMPILERS
from vision_core.startup import compile as compile_module
from vision_core.startup.compile import FRAME_PATH, OTHERS, STEPS, Step, compile_kernels
from vision_core.venues.loader import load_settings

WORKER = """
import sys, os
from vision_core.native.kernel_folder import CompiledKernel, choose_kernel_folder
from vision_core.native import kernel_folder
kernel_folder.kernel_fingerprint = lambda hashes: "0" * 16
sys.stdin.readline()
folder, _ = choose_kernel_folder()
for line in sys.stdin:
    if line == "fails\\n":
        sys.exit(3)
    folder.write(line.strip(), CompiledKernel("module." + line.strip(), "()", 1.5).encode(b"code"))
    print(line.strip(), flush=True)
"""


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Lines of the log, with workers that compile nothing."""
    worker = tmp_path / "worker.py"
    worker.write_text(WORKER)
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "data"))
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.setattr(kernel_folder, "kernel_fingerprint", lambda _hashes: "0" * 16)
    monkeypatch.setattr(compile_module, "WORKER", (str(worker),))
    monkeypatch.setattr(
        compile_module, "STEPS", (Step("first"), Step("second"), Step("last", after=("first", "second")))
    )
    return []


def run(log: list[str], go_on: Any = lambda: True) -> list[str]:
    """The progress."""
    shown: list[str] = []
    compile_kernels(load_settings(), compile_module.STEPS, show=shown.append, log=log.append, go_on=go_on)
    return shown


def test_every_step_has_its_compiler_and_waits_for_steps_before_it() -> None:
    assert {step.name for step in STEPS} == COMPILERS.keys()
    names = [step.name for step in STEPS]
    assert (*FRAME_PATH, *OTHERS) == STEPS
    assert all(names.index(other) < names.index(step.name) for step in STEPS for other in step.after)


def test_progress_ends_with_all_parts(log: list[str]) -> None:
    shown = run(log)
    assert shown[0].startswith("0 of 3 parts are compiled; now: first")
    assert shown[-2:] == ["2 of 3 parts are compiled; now: last", "3 of 3 parts are compiled"]
    (line,) = log
    assert line.startswith("compiled 3 kernels in ")
    assert "(4 s of processor time); the longest: " in line


def test_a_part_of_the_steps_is_compiled_first_and_the_rest_completes_it(log: list[str]) -> None:
    settings = load_settings()
    for steps in (compile_module.STEPS[:2], compile_module.STEPS[2:]):
        shown: list[str] = []
        compile_kernels(settings, steps, show=shown.append, log=log.append, go_on=lambda: True)
        assert shown[-1] == f"{len(steps)} of {len(steps)} parts are compiled"
        folder, _ = choose_kernel_folder()
        assert folder is not None
        assert is_complete(folder, "synthetic") == (steps[-1].name == "last")


def test_what_is_complete_is_not_compiled_again(log: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    run(log)
    monkeypatch.setattr(compile_module, "WORKER", ("-c", "raise SystemExit('started')"))
    log.clear()
    assert run(log) == ["3 of 3 parts were compiled before"]
    assert log == []


@pytest.mark.parametrize("damage", [Path.unlink, lambda path: path.write_bytes(path.read_bytes()[:-1])])
def test_what_is_damaged_is_compiled_again(log: list[str], damage: Any) -> None:
    run(log)
    log.clear()
    folder, _ = choose_kernel_folder()
    assert folder is not None
    damage(folder.path / "second")
    assert run(log)[-1] == "3 of 3 parts are compiled"
    assert folder.read("second") == CompiledKernel("module.second", "()", 1.5).encode(b"code")
    assert [line for line in log if "damaged" in line] == log[:-1]


def test_a_step_that_fails_is_named(log: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_module, "STEPS", (Step("first"), Step("fails")))
    with pytest.raises(ServiceError, match="compiling fails; found: exit status 3"):
        run(log)
    folder, _ = choose_kernel_folder()
    assert folder is not None
    assert not any(name.startswith("complete") for name in folder.names())


def test_it_stops_when_it_is_told(log: list[str]) -> None:
    assert len(run(log, go_on=lambda: False)) == 1
    assert log == []
