"""Where viewers are closed, nobody sees anything before he has logged in."""

from collections.abc import Iterator

import httpx
import pytest
from msgspec import structs
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from app.web.auth.identity import Role
from app.web.auth.people import People
from tests.app.fake_service import FakeService, Scene, running_service, served_page
from vision_core.venues.loader import load_settings

NEEDED_TO_LOG_IN = ("/", "/healthz", "/readyz", "/web/")
DATA = (
    "/api/v1/status",
    "/api/v1/field",
    "/api/v1/snapshot.jpg",
    "/api/v1/snapshot.png",
    "/api/v1/me",
    "/metrics",
    "/openapi.json",
    "/docs",
)
PASSWORD = "a long password"


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    settings = load_settings()
    server = structs.replace(settings.server, viewers="closed")
    with running_service(Scene(clients=1), structs.replace(settings, server=server)) as service:
        yield service


@pytest.fixture(scope="module")
def address(service: FakeService) -> Iterator[str]:
    with served_page(service, "/readyz") as address:
        yield address


def test_nobody_sees_anything_but_the_page_to_log_in(address: str) -> None:
    for path in DATA:
        for method in ("GET", "HEAD"):
            assert httpx.request(method, f"http://{address}{path}").status_code == 401, (method, path)
    for path in NEEDED_TO_LOG_IN:
        assert httpx.get(f"http://{address}{path}").status_code not in (401, 403), path
    for path in ("/live", "/view3d", "/view3d/"):
        with pytest.raises(InvalidStatus, match="403"):
            connect(f"ws://{address}{path}", proxy=None)


@pytest.mark.usefixtures("built_page")
def test_a_viewer_who_has_logged_in_sees_everything_and_changes_nothing(address: str, service: FakeService) -> None:
    people = People(service.people)
    people.set_password(Role.VIEWER, PASSWORD)
    people.close()
    with httpx.Client(base_url=f"http://{address}") as viewer:
        assert viewer.post("/api/v1/login", json={"secret": PASSWORD}).status_code == 200
        for path in DATA:
            assert viewer.get(path).status_code == 200, path
        assert viewer.post("/api/v1/match/swap_sides", json={}).status_code == 403


def test_a_team_sees_what_its_page_needs(address: str, service: FakeService) -> None:
    people = People(service.people)
    key = people.team_keys.renew("cgn")
    people.close()
    with httpx.Client(base_url=f"http://{address}") as team:
        assert team.post("/api/v1/login", json={"secret": key}).status_code == 200
        assert team.get("/api/v1/me").json()["team"] == "cgn"
        assert team.get("/api/v1/field").status_code == 200
        assert team.get("/api/v1/status").status_code == 403
        assert team.get("/api/v1/snapshot.jpg").status_code == 403
