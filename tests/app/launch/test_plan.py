"""The plan of a service: its processes with their modules and limits, and what is refused before anything starts."""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

from app.launch.plan import plan_service, prepare_data_folder
from app.supervisor.plan import ChildPlan, ServicePlan
from vision_core.errors import ServiceError
from vision_core.rtdb.task import ORDINARY_MAX_RUN_S
from vision_core.startup import PREFLIGHT
from vision_core.venues.loader import load_settings


@pytest.fixture
def plan() -> Iterator[ServicePlan]:
    """Of the default settings, on free ports."""
    made, _ = plan_service(load_settings(options={"server.port": 0, "server.udp_port": 0}), "1")
    yield made
    for opened in made.sockets.values():
        opened.close()


def child(plan: ServicePlan, name: str) -> ChildPlan:
    return next(each for each in plan.children if each.name == name)


def test_every_module_that_is_started_by_name_exists(plan: ServicePlan) -> None:
    for module in {PREFLIGHT, plan.spare_module, *(each.module for each in plan.children)}:
        assert find_spec(module) is not None, module


def test_an_ordinary_process_may_compute_for_long_and_a_real_time_one_may_not(plan: ServicePlan) -> None:
    assert {each.name for each in plan.children if not each.real_time} == {"compile", "source", "diagnose", "web"}
    assert child(plan, "diagnose").longest_run_s == ORDINARY_MAX_RUN_S
    assert child(plan, "perceive").longest_run_s == 1.0


def test_a_process_says_for_a_person_what_its_tasks_do(plan: ServicePlan) -> None:
    assert child(plan, "perceive").title == "perceive (finds robots and ball)"
    assert child(plan, "watch").purpose.startswith("finds where the field ends, checks that the camera was not moved")


@pytest.mark.parametrize("in_the_way", ["data", "data/jit"])
def test_a_data_folder_that_cannot_be_made_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, in_the_way: str
) -> None:
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "data"))
    (tmp_path / in_the_way).parent.mkdir(exist_ok=True)
    (tmp_path / in_the_way).touch()
    with pytest.raises(ServiceError, match=f"{tmp_path / 'data'}.*PSLV_DATA_DIR names another"):
        prepare_data_folder()


def test_a_data_folder_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path / "a" / "b"))
    prepare_data_folder()
    prepare_data_folder()
    assert (tmp_path / "a" / "b").is_dir()
