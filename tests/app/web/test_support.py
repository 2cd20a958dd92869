"""The log and the support bundle: for the operator, and the bundle without secrets."""

import io
import json
import zipfile
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from websockets.sync.client import connect

from app.web.auth.people import People
from app.web.configuration import sources
from app.web.support.redaction import TAKEN_OUT, without_secrets
from tests.app.fake_service import FakeService, running_service, served_page, starting_lines, wait_for
from tests.app.web.live.test_connection import refused, update
from vision_core.rtdb.log_record import LOG, LogLevel, LogLine, ServiceLog

CONTACT, EMAIL = "Ada, 0171 2345678", "ada@team.example"
TEAM = {"name": f"Robots {EMAIL}", "short_name": "RB", "contact": CONTACT, "robots": [1, 2]}


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    with running_service() as service:
        yield service


@pytest.fixture(scope="module")
def address(service: FakeService) -> Iterator[str]:
    with served_page(service) as address:
        wait_for(lambda: httpx.get(f"http://{address}/api/v1/snapshot.jpg").status_code == 200)
        yield address


def answer(service: FakeService, address: str, path: str, method: str = "GET", **sent: Any) -> httpx.Response:
    """The answer that the operator gets."""
    return httpx.request(method, f"http://{address}{path}", headers=service.operator, timeout=30.0, **sent)


def test_the_log_is_told_by_level_and_process(service: FakeService, address: str) -> None:
    service.put(LOG, ServiceLog(tuple(starting_lines()), 3, 40))

    def numbers(query: str = "") -> list[int]:
        log = answer(service, address, f"/api/v1/log{query}").json()
        assert (log["left_out"], log["older"]) == (3, 40)
        return [line["number"] for line in log["lines"]]

    assert numbers() == [1, 2, 3, 4, 5, 6]
    assert numbers("?level=warning") == [2, 4, 5, 6]
    assert numbers("?level=error") == [4, 5]
    assert numbers("?process=supervisor&level=warning") == [6]
    assert numbers("?process=nobody") == []
    assert answer(service, address, "/api/v1/log?level=worse").status_code == 422


@pytest.mark.parametrize("path", ["/api/v1/log", "/api/v1/support-bundle"])
def test_only_the_operator_may_read_them(service: FakeService, address: str, path: str) -> None:
    answer(service, address, "/api/v1/teams", "POST", json=TEAM)
    people = People(service.people)
    key = people.team_keys.renew("rb")
    people.close()
    assert httpx.get(f"http://{address}{path}").status_code == 401
    with httpx.Client(base_url=f"http://{address}") as team:
        assert team.post("/api/v1/login", json={"secret": key}).json()["role"] == "team"
        assert team.get(path).status_code == 403
    assert answer(service, address, path).status_code == 200


def test_the_live_log_is_the_operators_and_comes_when_something_is_new(service: FakeService, address: str) -> None:
    live = f"ws://{address}/live?topics=log"
    with connect(live, proxy=None) as stranger:
        assert refused(stranger) == "only the operator may see log"
    with connect(live, additional_headers=service.operator, proxy=None) as operator:
        service.put(LOG, ServiceLog((), 1, 0))
        assert update(operator)["log"]["topic"] == "log"
        line = LogLine(9, 1e9, LogLevel.INFO, "web", "news")
        service.put(LOG, ServiceLog((line,), 2, 0))
        log = update(operator)["log"]
        while log["left_out"] != 2:
            log = update(operator)["log"]
    assert log["lines"] == [{"number": 9, "at": 1e9, "level": "info", "process": "web", "text": "news", "times": 1}]


def test_the_bundle_says_what_is_in_it(service: FakeService, address: str) -> None:
    answered = answer(service, address, "/api/v1/support-bundle")
    assert answered.headers["content-type"] == "application/zip"
    assert "pslv-support-" in answered.headers["content-disposition"]
    with zipfile.ZipFile(io.BytesIO(answered.content)) as bundle:
        names = set(bundle.namelist())
        readme = bundle.read("README.txt").decode()
        content = {name: json.loads(bundle.read(name)) for name in names if name.endswith(".json")}
        assert bundle.read("snapshot.jpg").startswith(b"\xff\xd8")
    assert names == {line.split()[0] for line in readme.splitlines() if ".json  " in line or ".txt  " in line} | {
        "README.txt",
        "snapshot.jpg",
    }
    assert content["versions.json"]["pslv"] == "0.1.0"
    assert content["versions.json"]["cores"] > 0
    assert content["versions.json"]["numpy"] != "not installed"
    assert content["settings.json"]["settings"]["field"]["length_m"] == service.settings.field.length_m
    assert content["selftest.json"]["grade"] == "A"
    assert content["health.json"]["state"] in ("ready", "degraded")
    assert {row["name"] for row in content["processes.json"]} >= {"perceive", "serve", "web"}
    assert {row["name"] for row in content["tasks.json"]} >= {"perceive", "serve"}
    assert content["timing.json"]["lags"]["server"]["count"] > 0


def secrets_of(service: FakeService, address: str) -> list[str]:
    """Everything private that the service knows by now, also in its log, its settings and its history."""
    people = People(service.people)
    token, first_run, key = people.new_token("tests")[1], people.first_run_token() or "", people.team_keys.renew("rb")
    people.close()
    answer(service, address, "/api/v1/teams", "POST", json=TEAM | {"short_name": "RB2"})
    answer(service, address, "/api/v1/teams/rb2", "PUT", json=TEAM | {"short_name": "RB2", "contact": "Bob"})
    uri = {"changes": {"source.uri": "camera:rtsp://admin:hunter2@camera.example/1"}}
    assert answer(service, address, "/api/v1/settings", "PATCH", json=uri).status_code == 200
    printed = (
        f"log in here: http://127.0.0.1:8000/?token={first_run}",
        f"the header was Authorization: Bearer {token}",
        f"the team's link: http://127.0.0.1:8000/robot#key={key}",
        f"a request with {key} and with {token}",
        f"mail from <{EMAIL}> about password=hunter2",
    )
    lines = (LogLine(n, 1e9, LogLevel.INFO, "web", text) for n, text in enumerate(printed))
    service.put(LOG, ServiceLog(tuple(lines), 0, 0))
    return [token, token.removeprefix("pslv_"), first_run, key, CONTACT, EMAIL, "hunter2", "Bob"]


def test_no_file_of_the_bundle_holds_a_secret_or_a_contact(
    service: FakeService, address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sources, "check_source", lambda *_: None)  # as if the camera with the password were there
    secrets = secrets_of(service, address)
    packed = answer(service, address, "/api/v1/support-bundle").content
    with zipfile.ZipFile(io.BytesIO(packed)) as bundle:
        files = {name: bundle.read(name).decode(errors="replace") for name in bundle.namelist()}
    assert [(name, secret) for name, text in files.items() for secret in secrets if secret in text] == []
    assert files["log.txt"].count(TAKEN_OUT) == 7
    assert "RB2" in files["changes.json"]
    assert files["changes.json"].count(f'"contact": "{TAKEN_OUT}"') >= 3
    assert "source.uri" in files["changes.json"]


def test_what_is_no_secret_stays() -> None:
    told = {
        "path": "/home/vision/.local/share/pslv/0123456789abcdef0123456789abcdef0123456",
        "key": "settings/match.blue_defends",
        "contact": "",
        "text": f"no such key: tasks.foo; {'platform-linux-x86-64':-<43}",
        "numbers": [1, 2.5, None, True],
    }
    assert without_secrets(told) == told
