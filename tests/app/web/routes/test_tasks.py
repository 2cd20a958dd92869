"""Tasks are listed, slowed, switched off and put back over the API; what cannot be is refused in words."""

from collections.abc import Iterator

import httpx
import pytest

from app.web.problems import MEDIA_TYPE
from tests.app.fake_service import FakeService, PageServer, Scene, wait_for
from tests.app.fake_tasks import Condition
from vision_core.rtdb import records
from vision_core.rtdb.infos import TaskOverride

NOTHING = {"enabled": None, "period_ms": None, "priority": None, "rehearse": None}
TASKS = "/api/v1/tasks"


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    service = FakeService(Scene(condition=Condition(silent=("colors", "capture"))))
    service.start()
    yield service
    service.stop()


@pytest.fixture(scope="module")
def server(service: FakeService) -> Iterator[PageServer]:
    server = PageServer(service)
    server.start()
    yield server
    server.stop()


@pytest.fixture
def http(server: PageServer, service: FakeService) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=f"http://{server.address}", headers=service.operator) as client:
        wait_for(lambda: client.get("/healthz").status_code == 200)
        yield client
        for task in client.get(TASKS).json():
            client.delete(f"{TASKS}/{task['name']}")


def proposed(service: FakeService) -> dict[str, TaskOverride]:
    """What the service's processes read."""
    return records.LIVE_SETTINGS.reader(service.store).value(service.clock.now()).tasks


def task_of(http: httpx.Client, name: str) -> dict[str, object]:
    """One task as it is told."""
    (task,) = (task for task in http.get(TASKS).json() if task["name"] == name)
    return dict(task)


def test_every_task_is_listed_in_the_tables_order(http: httpx.Client, service: FakeService) -> None:
    assert [task["name"] for task in http.get(TASKS).json()] == [task.name for task in service.tasks]
    wait_for(lambda: task_of(http, "lines")["valid"])  # a loaded machine pauses the fake tasks
    lines = task_of(http, "lines")
    assert (lines["process"], lines["trigger"], lines["period_ms"], lines["offset_ms"]) == (
        "watch",
        "period",
        400.0,
        37.0,
    )
    assert (lines["priority"], lines["policy"], lines["overruns"], lines["valid"]) == (20, "FIFO 20", 1, True)
    assert lines["proposed"] is None


def test_a_task_that_has_not_reported_is_listed_as_the_table_has_it(http: httpx.Client) -> None:
    colors = task_of(http, "colors")
    assert (colors["process"], colors["period_ms"], colors["priority"]) == ("watch", 800.0, 15)
    assert colors["policy"] is colors["runs"] is colors["age_s"] is None
    assert colors["trigger"] == "period"
    assert colors["valid"] is False


def test_a_change_is_written_down_and_tells_how_to_undo_it(http: httpx.Client, service: FakeService) -> None:
    slower = http.patch(f"{TASKS}/obstacles", json={"period_ms": 250})
    assert slower.status_code == 200
    assert slower.json()["before"] == NOTHING
    assert slower.json()["task"]["proposed"] == NOTHING | {"period_ms": 250.0}
    off = http.patch(f"{TASKS}/obstacles", json={"enabled": False, "priority": 0}).json()
    assert off["before"] == NOTHING | {"period_ms": 250.0}
    assert off["task"]["proposed"] == NOTHING | {"enabled": False, "period_ms": 250.0, "priority": 0}, "others stay"
    assert proposed(service) == {"obstacles": TaskOverride(enabled=False, period_ms=250.0, priority=0)}
    wait_for(lambda: task_of(http, "obstacles")["enabled"] is False)
    undone = http.patch(f"{TASKS}/obstacles", json=off["before"]).json()
    assert undone["task"]["proposed"] == off["before"]
    wait_for(lambda: task_of(http, "obstacles")["enabled"] is True)


def test_a_period_may_be_shorter_than_the_offset(http: httpx.Client) -> None:
    assert task_of(http, "exposure")["offset_ms"] == 61.0
    assert http.patch(f"{TASKS}/exposure", json={"period_ms": 50}).status_code == 200


def test_null_and_delete_are_the_tables_value(http: httpx.Client, service: FakeService) -> None:
    http.patch(f"{TASKS}/lines", json={"period_ms": 500, "priority": 10})
    assert http.patch(f"{TASKS}/lines", json={"period_ms": None}).json()["task"]["proposed"]["priority"] == 10
    back = http.delete(f"{TASKS}/lines").json()
    assert back["before"] == NOTHING | {"priority": 10}
    assert back["task"]["proposed"] is None
    assert proposed(service) == {}
    assert http.delete(f"{TASKS}/lines").json()["before"] == NOTHING


def test_nothing_is_written_when_nothing_changes(http: httpx.Client, service: FakeService) -> None:
    reader = records.LIVE_SETTINGS.reader(service.store)
    http.patch(f"{TASKS}/lines", json={"period_ms": 500})
    sequence = reader.sequence
    assert http.patch(f"{TASKS}/lines", json={}).status_code == 200
    assert http.patch(f"{TASKS}/lines", json={"period_ms": 500.0}).status_code == 200
    assert http.delete(f"{TASKS}/serve").status_code == 200
    assert reader.sequence == sequence


def test_a_web_process_that_was_started_again_goes_on(http: httpx.Client, service: FakeService) -> None:
    http.patch(f"{TASKS}/lines", json={"period_ms": 500})
    second = PageServer(service)
    second.start()
    with httpx.Client(base_url=f"http://{second.address}", headers=service.operator) as client:
        assert client.patch(f"{TASKS}/obstacles", json={"enabled": False}).status_code == 200
        assert client.delete(f"{TASKS}/obstacles").status_code == 200
    second.stop()
    assert proposed(service) == {"lines": TaskOverride(period_ms=500.0)}


@pytest.mark.parametrize(
    ("name", "wish", "found", "accepted"),
    [
        ("obstacles", {"speed": 2}, '{"speed": 2}', "enabled, period_ms, priority, rehearse; not speed"),
        ("obstacles", {"priority": 91}, "91", "less than or equal to 90"),
        ("obstacles", {"priority": -1}, "-1", "greater than or equal to 0"),
        ("obstacles", {"priority": 4.5}, "4.5", "a valid integer"),
        ("obstacles", {"priority": True}, "true", "a valid integer"),
        ("obstacles", {"enabled": "yes"}, '"yes"', "a valid boolean"),
        ("obstacles", {"period_ms": -1}, "-1", "greater than or equal to 0"),
        ("obstacles", {"period_ms": 3.7e6}, "3700000.0", "less than or equal to 3600000"),
        ("obstacles", {"period_ms": 0.5}, "tasks.obstacles.period_ms: 0.5: an impossible rate", "1 ms or more"),
        (
            "boundary",
            {"period_ms": 5},
            "tasks.boundary.budget_ms: 10 for what comes every 5 ms: an impossible rate",
            "at most the time between two releases",
        ),
        ("lines", {"period_ms": 0}, "tasks.lines.period_ms: 0", "a period: nothing else releases it"),
        ("capture", {"period_ms": 50}, "its period is that of the camera", "null or 0"),
        ("source", {"period_ms": 50}, "its period is that of the task capture", "null or 0"),
        (
            "boundary",
            {"period_ms": 10},
            "tasks.boundary.budget_ms: budgets that fill 1.19 cores in process watch",
            "one core at most",
        ),
    ],
)
def test_what_cannot_be_is_refused(
    http: httpx.Client, name: str, wish: dict[str, object], found: str, accepted: str
) -> None:
    answer = http.patch(f"{TASKS}/{name}", json=wish)
    assert answer.status_code == 422
    assert answer.headers["content-type"] == MEDIA_TYPE
    problem = answer.json()
    assert (problem["found"], problem["accepted"]) == (found, accepted)
    assert problem["detail"] == f"{problem['asked']}; found: {found}; accepted: {accepted}"
    assert task_of(http, name)["proposed"] is None


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b"5", b'{"period_ms": NaN}', b"\xff\xfe", b"[" * 3000])
def test_garbage_is_refused(http: httpx.Client, body: bytes) -> None:
    answer = http.patch(f"{TASKS}/lines", content=body, headers={"content-type": "application/json"})
    assert answer.status_code in {400, 422}
    assert answer.headers["content-type"] == MEDIA_TYPE


def test_unknown_tasks_and_loops_of_their_own(http: httpx.Client) -> None:
    unknown = http.patch(f"{TASKS}/nobody", json={"enabled": False})
    assert unknown.status_code == 404
    assert "capture, source, perceive" in unknown.json()["accepted"]
    assert http.delete(f"{TASKS}/nobody").status_code == 404
    web = http.patch(f"{TASKS}/web", json={"enabled": False})
    assert web.status_code == 409
    assert web.json()["found"] == "it runs in a loop of its own"


def test_foreign_pages_change_nothing(http: httpx.Client, service: FakeService) -> None:
    for origin in ("http://evil.example", "null"):
        for method in ("PATCH", "DELETE"):
            answer = http.request(method, f"{TASKS}/lines", json={"enabled": False}, headers={"origin": origin})
            assert answer.status_code == 403, method
            assert answer.headers["content-type"] == MEDIA_TYPE
            assert "content-security-policy" in answer.headers
    ours = {"origin": str(http.base_url).rstrip("/")}
    assert http.patch(f"{TASKS}/lines", json={"enabled": False}, headers=ours).status_code == 200


def test_a_change_outlives_the_web_process() -> None:
    own = FakeService()
    for _ in range(2):
        server = PageServer(own)
        server.start()
        with httpx.Client(base_url=f"http://{server.address}", headers=own.operator) as client:
            if proposed(own) == {}:
                client.patch(f"{TASKS}/serve", json={"priority": 30})
            assert task_of(client, "serve")["proposed"] == NOTHING | {"priority": 30}
        server.stop()
        assert proposed(own) == {"serve": TaskOverride(priority=30)}
    own.stop()
