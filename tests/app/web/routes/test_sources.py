"""A source is chosen among those that there are; one that a start could not open is refused with the reason."""

import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import numpy as np
import pytest

from app.web.configuration import sources
from app.web.problems import RequestRefused
from app.web.routes.api import file_name
from tests.app.fake_service import FakeService, asked_by_operator, running_service, wait_for
from vision_core.native.opencv import read_picture, write_picture
from vision_core.rtdb.infos import ServiceInfo
from vision_core.settings.layers import Layer, LayerKind

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    with running_service() as service:
        yield service


@pytest.fixture(scope="module")
def http(service: FakeService) -> Iterator[httpx.Client]:
    with asked_by_operator(service, 60.0) as http:
        yield http


def chosen(http: httpx.Client, uri: str | None) -> httpx.Response:
    return http.patch("/settings", json={"changes": {"source.uri": uri}})


def test_cameras_of_the_machine_are_offered(
    http: httpx.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("video10", "video2", "video-odd", "null"):
        (tmp_path / name).touch()
    monkeypatch.setattr(sources, "DEVICES", tmp_path)
    found = http.get("/sources").json()
    assert found["choices"] == ["synthetic", "camera:2", "camera:10"]
    assert (found["uri"], found["running"], found["is_chosen_at_start"]) == ("synthetic", "synthetic", False)


def test_a_viewer_does_not_see_the_machines_cameras(http: httpx.Client) -> None:
    assert httpx.get(f"{http.base_url}sources").status_code == 401


def test_a_source_that_is_there_waits_for_the_next_start(http: httpx.Client, tmp_path: Path) -> None:
    picture = tmp_path / "still.png"
    write_picture(picture, np.zeros((480, 640, 3), dtype=np.uint8))
    answer = chosen(http, f"file:{picture}")
    assert answer.is_success, answer.text
    assert answer.json()["needs_restart"] == ["source.uri"]
    found = http.get("/sources").json()
    assert (found["uri"], found["running"]) == (f"file:{picture}", "synthetic")
    assert f"file:{picture}" in found["choices"]
    assert chosen(http, None).is_success


@pytest.mark.parametrize(
    ("uri", "found", "accepted"),
    [
        ("file:/nowhere/a.png", "No such file", "a picture, a folder or a video"),
        ("film:a", "film:a", "synthetic, file:"),
        ("camera:97", "no such device", "/dev/video|none"),
    ],
)
def test_a_source_that_is_not_there_is_refused(http: httpx.Client, uri: str, found: str, accepted: str) -> None:
    answer = chosen(http, uri)
    assert answer.status_code == 422
    problem = answer.json()
    assert problem["field"] == "source.uri"
    assert uri in problem["asked"]
    assert found in problem["found"]
    assert re.search(accepted, problem["accepted"])
    assert http.get("/sources").json()["uri"] == "synthetic"


def test_the_command_line_comes_first(service: FakeService) -> None:
    info = ServiceInfo("", service.boot, "", "", service.settings, ())
    assert not sources.is_chosen_at_start(info)
    options = Layer("command line", {"source": {"uri": "synthetic"}}, kind=LayerKind.OPTIONS)
    info = ServiceInfo("", service.boot, "", "", service.settings, (), layers=(options,))
    assert sources.is_chosen_at_start(info)
    with pytest.raises(RequestRefused, match="without --source"):
        sources.check_source(service.settings, info)


def test_a_snapshot_is_named_after_its_source_and_time(http: httpx.Client, tmp_path: Path) -> None:
    wait_for(lambda: http.get("/snapshot.png").status_code == 200)
    answer = http.get("/snapshot.png")
    name = re.search(
        r'attachment; filename="(synthetic-\d{8}-\d{6}-\d{3}\.png)"', answer.headers["content-disposition"]
    )
    assert name is not None
    assert int(answer.headers["x-frame-number"]) > 0
    (tmp_path / name[1]).write_bytes(answer.content)
    assert read_picture(tmp_path / name[1]).shape == (480, 640, 3)
    assert file_name("file:/a b/final game.mp4", 0.0).startswith("final-game-")
    assert file_name("camera:/dev/video3", 0.0).startswith("camera-dev-video3-")
