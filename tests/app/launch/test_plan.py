"""The plan of a service: its processes with their modules and limits, and what is refused before anything starts."""

import contextlib
import os
import stat
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

from app.launch.plan import plan_service, prepare_kernel_folder, service_info
from app.launch.prepared import Prepared
from app.launch.sockets import open_sockets
from app.supervisor.plan import ChildPlan, ServicePlan
from vision_core.clock import Instant
from vision_core.errors import ServiceError
from vision_core.native import kernel_folder
from vision_core.native.kernel_folder import VARIABLE
from vision_core.rtdb.task import ORDINARY_MAX_RUN_S
from vision_core.startup import PREFLIGHT
from vision_core.venues.loader import layers_of, settings_from_layers


@pytest.fixture(autouse=True)
def _own_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_folder, "kernel_fingerprint", lambda _hashes: "0" * 16)
    monkeypatch.setattr(kernel_folder, "_private_roots", lambda: iter([tmp_path / "private"]))
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "a" / "data"))
    monkeypatch.setenv(VARIABLE, "")


@pytest.fixture
def prepared() -> Prepared:
    """The default settings, on free ports."""
    layers = layers_of(options={"server.port": 0, "server.udp_port": 0})
    return Prepared(settings_from_layers(layers), layers, Path("venue.db"), "default")


@contextlib.contextmanager
def laid_out(prepared: Prepared, *, compiles: bool) -> Iterator[ServicePlan]:
    """The plan of a service with these settings."""
    sockets = open_sockets(prepared.settings.server)
    info = service_info(prepared, sockets, version="1", boot=Instant(1), restarts=0)
    made = plan_service(info, sockets, compiles=compiles)
    try:
        yield made
    finally:
        for opened in made.sockets.values():
            opened.close()


@pytest.fixture
def plan(prepared: Prepared) -> Iterator[ServicePlan]:
    """Of a first start."""
    with laid_out(prepared, compiles=True) as made:
        yield made


def child(plan: ServicePlan, name: str) -> ChildPlan:
    return next(each for each in plan.children if each.name == name)


def test_every_module_that_is_started_by_name_exists(plan: ServicePlan) -> None:
    for module in {PREFLIGHT, plan.spare_module, *(each.module for each in plan.children)}:
        assert find_spec(module) is not None, module


def test_an_ordinary_process_may_compute_for_long_and_a_real_time_one_may_not(plan: ServicePlan) -> None:
    ordinary = {each.name for each in plan.children if not each.real_time}
    assert ordinary == {"log_reader", "compile", "compile_others", "responder", "source", "follow", "diagnose", "web"}
    assert child(plan, "diagnose").longest_run_s == ORDINARY_MAX_RUN_S
    assert child(plan, "perceive").longest_run_s == 1.0


def test_the_frame_path_waits_for_its_own_kernels_alone(plan: ServicePlan) -> None:
    after = {each.name: each.after for each in plan.children}
    assert {name for name, other in after.items() if not other} == {"log_reader", "compile", "responder", "web"}
    assert {name for name, other in after.items() if other == "compile"} == {
        *("compile_others", "capture", "source", "perceive", "serve"),
    }
    assert after["diagnose"] == after["watch"] == "compile_others"
    assert [each.name for each in plan.children if each.may_fail] == ["compile_others"]


def test_with_all_kernels_on_disk_what_watches_waits_for_the_page(prepared: Prepared) -> None:
    with laid_out(prepared, compiles=False) as plan:
        after = {each.name: each.after for each in plan.children}
    assert {name for name, other in after.items() if not other} == {
        *("log_reader", "responder", "capture", "source", "perceive", "serve", "web"),
    }
    assert set(after.values()) == {"", "web"}


def test_a_process_says_for_a_person_what_its_tasks_do(plan: ServicePlan) -> None:
    assert child(plan, "perceive").title == "perceive (finds robots and ball)"
    assert child(plan, "watch").purpose.startswith("finds where the field ends, checks that the camera was not moved")


def test_the_data_folder_is_made(tmp_path: Path) -> None:
    assert prepare_kernel_folder() == prepare_kernel_folder() == ()
    assert stat.S_IMODE((tmp_path / "a" / "data").stat().st_mode) == 0o700
    assert not os.environ[VARIABLE]


@pytest.mark.parametrize("in_the_way", ["a/data", "a/data/jit"])
def test_the_service_starts_without_a_data_folder(tmp_path: Path, in_the_way: str) -> None:
    (tmp_path / in_the_way).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / in_the_way).touch()
    (line,) = prepare_kernel_folder()
    assert str(tmp_path / in_the_way) in line
    assert f"kept in {tmp_path / 'private' / 'jit'}" in line
    assert os.environ[VARIABLE] == str(tmp_path / "private")
    assert prepare_kernel_folder() == (), "processes of the service take the same folder without a word"


def test_damaged_files_are_said_once(tmp_path: Path) -> None:
    prepare_kernel_folder()
    file = tmp_path / "a" / "data" / "jit" / ("0" * 16) / "kernel"
    file.write_bytes(b"cut")
    (line,) = prepare_kernel_folder()
    assert "damaged files are deleted" in line
    assert not file.exists()
    assert prepare_kernel_folder() == ()


def test_no_folder_at_all_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").touch()
    monkeypatch.setattr(kernel_folder, "_private_roots", lambda: iter([tmp_path / "a" / "private"]))
    with pytest.raises(ServiceError, match=f"{tmp_path / 'a'}.*accepted: PSLV_DATA_DIR names"):
        prepare_kernel_folder()
