"""The HTTP side, over a real socket."""

import gzip
import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import numpy as np
import pytest

from app.commands.openapi import document
from app.web.blackboard import Blackboard
from app.web.health.monitor import HealthMonitor, HealthState
from app.web.problems import MEDIA_TYPE
from app.web.reports.status import Status, status_from
from app.web.routes.pages import web_folder
from tests.app.fake_service import STATES, FakeService, PageServer, Scene, wait_for
from tests.app.fake_tasks import Condition
from tests.conftest import ROOT
from vision_core.clock import after
from vision_core.rtdb import records
from vision_core.types.objects import Diagnosis
from vision_core.types.reasons import Reason

READ = (
    "/healthz",
    "/readyz",
    "/metrics",
    "/api/v1/status",
    "/api/v1/field",
    "/api/v1/snapshot.jpg",
    "/api/v1/tasks",
    "/api/v1/timing",
)


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    service = FakeService()
    service.start()
    yield service
    service.stop()


@pytest.fixture(scope="module")
def http(service: FakeService) -> Iterator[httpx.Client]:
    server = PageServer(service)
    server.start()
    with httpx.Client(base_url=f"http://{server.address}") as client:
        wait_for(lambda: client.get("/readyz").status_code == 200)
        yield client
    server.stop()


def status_of(service: FakeService) -> Status:
    """The status at the first look."""
    snapshot = Blackboard(service.store).read()
    return status_from(snapshot, HealthMonitor().judge(snapshot))


def test_healthz(http: httpx.Client) -> None:
    response = http.get("/healthz")
    assert (response.status_code, response.json()) == (200, {"status": "ok"})


def test_ready(http: httpx.Client) -> None:
    served = {"state": "ready", "ready": True, "reasons": [], "degraded": [], "advice": []}
    wait_for(lambda: http.get("/readyz").json() == served)  # a loaded machine pauses the fake camera


def test_not_ready_while_compiling() -> None:
    service = FakeService(STATES["compiling"])
    service.write_processes()
    server = PageServer(service)
    server.start()
    with httpx.Client(base_url=f"http://{server.address}") as client:
        response = client.get("/readyz")
        status = client.get("/api/v1/status").json()
        snapshot = client.get("/api/v1/snapshot.jpg")
    server.stop()
    assert response.status_code == 503
    assert response.json() == {
        "state": "not_ready",
        "ready": False,
        "reasons": ["compiling: 3 of 7: label pixels"],
        "degraded": [],
        "advice": ["Wait: a first start compiles for about half a minute."],
    }
    assert status["ready"] is False
    assert status["source"] is None
    assert status["cameras"][0]["age_s"] is status["cameras"][0]["lines"] is None
    assert status["clients"] == []
    assert snapshot.status_code == 503
    assert snapshot.headers["content-type"] == MEDIA_TYPE
    assert snapshot.json()["detail"] == "no image yet"


def test_status_tells_everything(http: httpx.Client, service: FakeService) -> None:
    wait_for(lambda: http.get("/api/v1/status").json()["cameras"][0]["measured_rate_hz"])  # a loaded machine is late
    status = http.get("/api/v1/status").json()
    assert status["ready"] is True
    assert status["reasons"] == []
    assert status["source"] == {"uri": "synthetic", "description": "simulated ceiling camera", "repeats": False}
    (camera,) = status["cameras"]
    assert (camera["name"], camera["width_px"], camera["height_px"]) == ("main", 640, 480)
    assert (camera["robots"], camera["balls"], camera["obstacles"], camera["measured_rate_hz"]) == (10, 1, 2, 30.0)
    assert 0.0 <= camera["age_s"] < 5.0
    watched = {name: camera[name] for name in ("boundary", "lines", "contours", "exposure", "colors")}
    assert all(0.0 <= finding.pop("age_s") < 5.0 for finding in watched.values())
    blue = {"team": "blue", "id": 3}
    assert watched == {
        "boundary": {"found": 0.94, "error_px": 0.3, "off_px": 0.6},
        "lines": {"known": 12, "found": 11, "samples": 0.97, "residual_px": 0.4, "outside": 0.0},
        "contours": {"ball": "may be hidden", "hiding": [blue], "can_hide_ball": [blue]},
        "exposure": {"brightest": 231.0, "median_luma": 88.0, "white": 0.001, "reasons": []},
        "colors": {"gain_bgr": [1.02, 1.0, 0.97], "reason": ""},
    }
    assert len(status["clients"]) == 10
    assert status["clients"][2]["dropped"] == 3
    assert (status["clients"][0]["network_ms"], status["clients"][1]["network_ms"]) == (0.1, None)
    assert status["lags"] == {
        "server": {"median_ms": 12.4, "max_ms": 19.8},
        "network": {"median_ms": pytest.approx(0.15), "max_ms": pytest.approx(0.19)},
        "client": {"median_ms": 2.0, "max_ms": 2.0},
        "shutter_delay_ms": 0.0,
    }
    assert (status["selftest"]["grade"], status["selftest"]["policy"]) == ("A", "FIFO 50")
    states = {process["name"]: process["state"] for process in status["processes"]}
    running = (
        "capture",
        "source",
        "perceive",
        "serve",
        "obstacles",
        "watch",
        "follow",
        "diagnose",
        "web",
        "spare-1",
        "spare-2",
    )
    assert states == {"compile": "done", "compile_others": "done", **dict.fromkeys(running, "running")}


def test_lags_that_nobody_reports_are_null() -> None:
    own = FakeService(Scene(condition=Condition(reporting=False)))
    own.write_frame()
    lags = status_of(own).lags
    assert lags.server is not None
    assert lags.network is lags.client is None


def test_a_degraded_service_is_ready_and_says_so() -> None:
    own = FakeService(STATES["degraded"])
    own.write_processes()
    own.write_tasks()
    own.write_frame()
    own.write_frame()  # the first one takes its time
    status = status_of(own)
    assert (status.state, status.ready) == (HealthState.DEGRADED, True)
    assert [alarm.text for alarm in status.alarms] == [
        "views may be late when this machine is busy",
        "views may be late when this machine is busy",
        "this machine keeps time badly",
        "a part of the service has been given up",
    ]
    assert status.degraded == [f"{alarm.text}: {alarm.detail}" for alarm in status.alarms]


def test_reasons_are_told_for_five_seconds() -> None:
    own = FakeService(STATES["explained"])
    own.write_frame()
    assert status_of(own).cameras[0].reasons == [str(reason) for reason in own.scene.reasons]
    diagnosis = records.diagnosis("main")
    now = own.clock.now()
    for age_s, told in ((4.0, ["one. Do it."]), (5.1, [])):
        grabbed = after(now, -age_s)
        own.put(diagnosis, Diagnosis("main", 1, grabbed, (Reason("one", "Do it."),)), grabbed)
        assert status_of(own).cameras[0].reasons == told


def test_snapshot_is_the_newest_picture_in_full_size(http: httpx.Client) -> None:
    response = http.get("/api/v1/snapshot.jpg")
    assert response.headers["content-type"] == "image/jpeg"
    assert response.content.startswith(b"\xff\xd8")
    size = _jpeg_size(response.content)
    assert size == (640, 480)
    assert int(response.headers["x-frame-number"]) > 0


def _jpeg_size(data: bytes) -> tuple[int, int]:
    """From the start-of-frame segment."""
    at = data.index(b"\xff\xc0")
    height, width = np.frombuffer(data[at + 5 : at + 9], dtype=">u2")
    return int(width), int(height)


def test_unknown_paths_are_problems(http: httpx.Client, service: FakeService) -> None:
    for path in (
        "/nothing",
        "/web/nothing.js",
        "/api/v1/nothing",
        "/web/../app/server.py",
        "/web/%2e%2e/pyproject.toml",
    ):
        response = http.get(path)
        assert response.status_code == 404, path
        assert response.headers["content-type"] == MEDIA_TYPE
        assert response.json()["status"] == 404
    assert http.post("/api/v1/status", headers=service.operator).json()["title"] == "Method Not Allowed"


@pytest.mark.usefixtures("built_page")
def test_a_browser_that_goes_astray_gets_the_page_with_status_404(http: httpx.Client) -> None:
    browser = {"accept": "text/html,application/xhtml+xml,*/*;q=0.8"}
    for path in ("/nothing", "/match/2", "/robot/blue"):
        answer = http.get(path, headers=browser)
        assert (answer.status_code, answer.headers["content-type"]) == (404, "text/html; charset=utf-8"), path
        assert answer.text == http.get("/").text
    for path in ("/api/v1/nothing", "/api/nothing", "/web/nothing.js"):
        assert http.get(path, headers=browser).headers["content-type"] == MEDIA_TYPE, path
    assert http.post("/nothing", headers=browser).headers["content-type"] == MEDIA_TYPE


@pytest.mark.usefixtures("built_page")
def test_pages_load_nothing_from_elsewhere(http: httpx.Client) -> None:
    styles = [f"/web/assets/{path.name}" for path in (web_folder() / "assets").glob("*.css")]
    assert styles
    for path in ("/", "/teams", "/robot/blue/3", "/docs", "/web/docs.js", "/web/favicon.svg", *styles):
        response = http.get(path)
        assert response.status_code == 200, path
        assert "default-src 'self'" in response.headers["content-security-policy"]
        outside = response.text.replace("http://www.w3.org/2000/svg", "")
        assert "//cdn" not in outside
        assert "http://" not in outside
        assert "https://" not in outside


@pytest.mark.usefixtures("built_page")
def test_the_first_page_is_small() -> None:
    index = (web_folder() / "index.html").read_text()
    files = re.findall(r"/web/(assets/[^\"]+)", index)
    packed = sum(len(gzip.compress((web_folder() / name).read_bytes())) for name in files)
    assert 50_000 < packed < 500_000


def test_while_the_page_is_missing_a_short_one_says_why(
    http: httpx.Client, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("app.web.routes.pages.web_folder", lambda: tmp_path / "dist")
    (tmp_path / "dist.state").write_text("getting its libraries from the <npm> registry")
    answer = http.get("/teams")
    assert answer.status_code == 503
    assert "getting its libraries from the &lt;npm&gt; registry" in answer.text
    assert http.get("/api/v1/status").status_code == 200


def test_the_types_of_the_front_end_are_those_of_the_api() -> None:
    """``make types`` makes them anew."""
    types = (ROOT / "web" / "src" / "api" / "schema.d.ts").read_text()
    schemas = document()["components"]["schemas"]
    for name, schema in schemas.items():
        assert f"        {name}: " in types or f"        {name}:" in types, name
        for field in schema.get("properties", {}):
            assert f"            {field}: " in types or f"            {field}?: " in types, (name, field)


def test_every_operation_and_field_is_described(http: httpx.Client) -> None:
    api = http.get("/openapi.json").json()
    assert set(READ) <= api["paths"].keys()
    for path, methods in api["paths"].items():
        assert all(operation["description"] for operation in methods.values()), path
    camera = api["components"]["schemas"]["CameraReport"]["properties"]
    assert camera["reasons"]["description"].startswith("Why nothing, or too little, is detected, ")


def test_refusals_are_described_once() -> None:
    described = document()
    contents = [
        response["content"][MEDIA_TYPE]["schema"]
        for methods in described["paths"].values()
        for operation in methods.values()
        for response in operation["responses"].values()
        if MEDIA_TYPE in response.get("content", {})
    ]
    assert len(contents) > 100
    assert all(schema == {"$ref": "#/components/schemas/ProblemDetails"} for schema in contents)
    assert described["components"]["schemas"]["ProblemDetails"]["properties"].keys() >= {"detail", "accepted"}


def test_field_has_what_the_page_draws(http: httpx.Client) -> None:
    field = http.get("/api/v1/field").json()
    assert field["edge_types"]["robot_yellow"]["code"] == 48
    assert field["numbers"] == 5
    assert field["robots"]["blue"] == field["robots"]["yellow"] == {"outline": "circle", "radius_m": 0.09}
    assert {segment["kind"] for segment in field["segments"]} == {1, 2, 3}


def test_heartbeat(http: httpx.Client, service: FakeService) -> None:
    beats, reader = service.store.reader("heartbeat/web"), records.task("web").reader(service.store)
    first, told = beats.sequence, reader.sequence
    wait_for(lambda: reader.sequence >= told + 2)
    assert beats.sequence >= first + 2 * (reader.sequence - told), "heartbeats are more frequent than metrics"
    info = reader.value(service.clock.now())
    assert info.note == "0 pages open"
    assert (info.process, info.trigger, info.policy, info.refusals, info.missed) == ("web", "none", "ordinary", (), 0)


def test_head_is_get_without_a_body(http: httpx.Client) -> None:
    for path in ("/", "/healthz", "/api/v1/field", "/metrics"):
        head, get = http.head(path), http.get(path)
        assert (head.status_code, head.content) == (200, b""), path
        assert head.headers["content-type"] == get.headers["content-type"]


def test_what_a_stranger_sent_is_repeated_in_few_words(http: httpx.Client) -> None:
    answer = http.get(f"/{'x' * 20_000}")
    assert answer.status_code == 404
    assert len(answer.content) < 500
