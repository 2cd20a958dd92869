"""Who may do what: every unsafe route, every role, foreign hosts and origins; generated from the OpenAPI document."""

import socket
from collections.abc import Iterator

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from app.web.auth.addresses import is_our_name
from app.web.auth.identity import Role
from app.web.auth.people import People
from app.web.auth.rules import READING
from tests.app.fake_service import FakeService, PageServer, Scene, running_service, served_page, wait_for

PASSWORD = "a long password"
OPEN = {("POST", "/api/v1/login"), ("POST", "/api/v1/logout")}
SOCKETS = ("/live", "/view3d", "/view3d/")


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    with running_service(Scene(clients=1)) as service:
        yield service


@pytest.fixture(scope="module")
def address(service: FakeService) -> Iterator[str]:
    with served_page(service) as address:
        yield address


@pytest.fixture(scope="module")
def people(service: FakeService) -> Iterator[People]:
    people = People(service.people)
    yield people
    people.close()


def operations(address: str) -> list[tuple[str, str]]:
    """Every method and path of the API; what stands in braces is replaced."""
    paths = httpx.get(f"http://{address}/openapi.json").json()["paths"]
    named = {
        "{color}": "blue",
        "{team}": "blue",
        "{number}": "1",
        "{slug}": "cgn",
        "{name}": "serve",
        "{address}": "10.0.0.1",
        "{index}": "0",
        "{form}": "pdf",
    }

    def filled(path: str) -> str:
        for name, value in named.items():
            path = path.replace(name, value)
        assert "{" not in path, path
        return path

    return [(method.upper(), filled(path)) for path, methods in paths.items() for method in methods]


def unsafe(address: str) -> list[tuple[str, str]]:
    found = [
        (method, path) for method, path in operations(address) if method not in READING and (method, path) not in OPEN
    ]
    assert len(found) > 20
    return found


def test_nobody_changes_anything_without_being_known(address: str) -> None:
    for method, path in unsafe(address):
        answer = httpx.request(method, f"http://{address}{path}", json={})
        assert answer.status_code == 401, (method, path)
        assert "pslv token" in answer.json()["detail"]


def test_viewers_and_teams_change_nothing(address: str, people: People) -> None:
    people.set_password(Role.VIEWER, PASSWORD)
    for secret in (PASSWORD, people.team_keys.renew("cgn")):
        with httpx.Client(base_url=f"http://{address}") as http:
            assert http.post("/api/v1/login", json={"secret": secret}).status_code == 200
            for method, path in unsafe(address):
                assert http.request(method, path, json={}).status_code == 403, (method, path)


def test_the_operator_gets_past_the_gate(address: str, service: FakeService) -> None:
    for method, path in unsafe(address):
        if path.endswith(("/password", "/tokens/1")):
            continue
        answer = httpx.request(method, f"http://{address}{path}", json={}, headers=service.operator)
        assert answer.status_code not in (401, 403), (method, path, answer.text)


def test_foreign_hosts_get_nothing(address: str) -> None:
    for method, path in [*operations(address), ("GET", "/"), ("GET", "/web/"), ("GET", "/docs")]:
        answer = httpx.request(method, f"http://{address}{path}", headers={"host": "evil.example"})
        assert answer.status_code == 421, (method, path)
    for path in SOCKETS:
        host, _, port = address.rpartition(":")
        with socket.create_connection((host, int(port))) as opened, pytest.raises(InvalidStatus, match="403"):
            connect(f"ws://evil.example{path}", sock=opened, proxy=None)


def test_foreign_origins_change_nothing_and_open_no_connection(address: str, service: FakeService) -> None:
    for origin in ("http://evil.example", "null", "http://[", ""):
        for method, path in unsafe(address):
            headers = {**service.operator, "origin": origin}
            answer = httpx.request(method, f"http://{address}{path}", json={}, headers=headers)
            assert answer.status_code == 403, (method, path)
        for method, path in operations(address):
            if method in READING:
                answer = httpx.request(method, f"http://{address}{path}", headers={"origin": origin})
                assert answer.status_code == 403, (method, path)
        for path in SOCKETS:
            with pytest.raises(InvalidStatus, match="403"):
                connect(f"ws://{address}{path}", additional_headers={"origin": origin}, proxy=None)


def test_changes_come_as_json_and_in_few_words(address: str, service: FakeService) -> None:
    url = f"http://{address}/api/v1/match/swap_sides"
    for kind in ("text/plain", "application/x-www-form-urlencoded", ""):
        answer = httpx.post(url, content=b"{}", headers={**service.operator, "content-type": kind})
        assert answer.status_code == 415, kind
    octets = {**service.operator, "content-type": "application/octet-stream"}
    assert httpx.post(url, content=b"{}", headers=octets).status_code == 415
    headers = {**service.operator, "content-type": "application/json"}
    assert httpx.post(url, content=b" " * 5000, headers=headers).status_code == 413
    assert httpx.post(url, content=iter([b"{}"]), headers=headers).status_code == 411
    pictures = f"http://{address}/api/v1/new-venue/pictures?name=large.png"
    assert httpx.post(pictures, content=b" " * 5000, headers=octets).status_code == 422, "a file may be longer"
    assert httpx.post(pictures, content=bytes(33 << 20), headers=octets).status_code == 413


def test_a_session_is_a_cookie_that_scripts_cannot_read(address: str, people: People) -> None:
    with httpx.Client(base_url=f"http://{address}") as http:
        people.set_password(Role.VIEWER, PASSWORD)
        answer = http.post("/api/v1/login", json={"secret": PASSWORD})
        cookie = answer.headers["set-cookie"].lower()
        assert "httponly" in cookie
        assert "samesite=strict" in cookie
        assert PASSWORD not in cookie
        assert http.get("/api/v1/me").json()["role"] == "viewer"
        http.post("/api/v1/logout")
        assert http.get("/api/v1/me").json()["name"] == "viewer"


def test_in_a_match_the_newest_picture_is_the_operators(address: str, service: FakeService, people: People) -> None:
    snapshot, match = f"http://{address}/api/v1/snapshot.jpg", f"http://{address}/api/v1/match"
    wait_for(lambda: httpx.get(snapshot).status_code == 200)
    assert httpx.patch(match, json={"mode": "match"}, headers=service.operator).status_code == 200
    try:
        with httpx.Client() as team:
            key = people.team_keys.renew("cgn")
            assert team.post(f"http://{address}/api/v1/login", json={"secret": key}).status_code == 200
            png = snapshot.replace("jpg", "png")
            for refused in (httpx.get(snapshot), httpx.head(snapshot), team.get(snapshot), httpx.get(png)):
                assert refused.status_code == 403
        assert httpx.get(snapshot, headers=service.operator).status_code == 200
    finally:
        assert httpx.patch(match, json={"mode": "practice"}, headers=service.operator).status_code == 200


def test_who_guesses_has_to_wait_and_is_written_down(service: FakeService, people: People) -> None:
    server = PageServer(service)
    server.start()
    with httpx.Client(base_url=f"http://{server.address}") as http:
        wait_for(lambda: http.get("/healthz").status_code == 200)
        codes = [http.post("/api/v1/login", json={"secret": f"guess {n}"}).status_code for n in range(7)]
        assert codes[:5] == [401] * 5
        assert codes[-1] == 429
        assert int(http.post("/api/v1/login", json={"secret": "x"}).headers["retry-after"]) >= 1
    server.stop()
    assert any(entry.kind == "failure" and entry.times >= 5 for entry in people.audit.entries(20))


@pytest.mark.parametrize(
    "host",
    [
        "127.0.0.1",
        "127.0.0.1:8000",
        "[::1]:8000",
        "[fe80::1]",
        "localhost:8000",
        "LOCALHOST",
        "192.168.1.5",
        "pslv.example:80",
    ],
)
def test_our_names(host: str) -> None:
    assert is_our_name(host, ["pslv.example"])


@pytest.mark.parametrize(
    "host", ["", "evil.example", "evil.example:8000", "127.0.0.1.evil.example", "localhost.evil.example", "a:b:c"]
)
def test_names_that_lead_here_but_are_not_ours(host: str) -> None:
    assert not is_our_name(host, ["pslv.example"])
