"""The live connection: one update under way at most, always the newest, and to everybody what is his."""

import base64
import json
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

import httpx
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.sync.connection import Connection

from app.web.auth.identity import Role
from app.web.auth.people import People
from app.web.live import connection as live
from app.web.live.topics import HEADER, PICTURE_KIND, VIEW_HEADER, VIEWS_KIND
from tests.app.fake_service import FakeService, PageServer, wait_for
from vision_core.protocol.answers import decode_message
from vision_core.protocol.messages import See
from vision_core.rtdb import records

TEAM = {"name": "Köln", "short_name": "CGN", "robots": [1, 2, 3, 4, 5]}


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    service = FakeService()
    service.write_processes()
    service.write_frame()
    service.start()
    yield service
    service.stop()


@pytest.fixture
def server(service: FakeService) -> Iterator[PageServer]:
    server = PageServer(service)
    server.start()
    yield server
    server.stop()


def page(server: PageServer, topics: str = "status", headers: Mapping[str, str] | None = None) -> Connection:
    return connect(
        f"ws://{server.address}/live?topics={topics}", additional_headers=headers or {}, proxy=None, max_size=None
    )


def update(connection: Connection) -> dict[str, Any]:
    """Ask for an update: its messages by topic, binary ones by their kind."""
    connection.send("next")
    found: dict[str, Any] = {}
    while True:
        message = connection.recv(timeout=10)
        if isinstance(message, bytes):
            found[{PICTURE_KIND: "picture", VIEWS_KIND: "views"}[message[0]]] = message
            continue
        decoded = json.loads(message)
        if decoded["topic"] == "end":
            return found
        found[decoded["topic"]] = decoded


def refused(connection: Connection) -> str:
    """The reason for which a connection is closed."""
    try:
        while True:
            connection.send("next")
            connection.recv(timeout=10)
    except ConnectionClosed as closed:
        return closed.rcvd.reason if closed.rcvd else "without a reason"


def test_the_status_has_match_and_revision(server: PageServer) -> None:
    with page(server) as connection:
        status = update(connection)["status"]
    assert status["match"]["blue_defends"] == "left"
    assert status["revision"] == status["match"]["revision"]
    assert status["pages"] == 1
    assert status["status"]["version"]


def test_the_world_has_robots_ball_and_obstacles(server: PageServer) -> None:
    with page(server, "world") as connection:
        wait_for(lambda: len(update(connection)["world"]["robots"]) == 10)
        world = update(connection)["world"]
    assert 0.0 < world["grabbed_s"] <= world["now_s"]
    assert world["valid"]
    assert {robot["team"] for robot in world["robots"]} == {"blue", "yellow"}
    assert [obstacle["radius_m"] for obstacle in world["obstacles"]] == [0.11, 0.06]
    assert len(json.dumps(world)) < 5000


def test_pictures_and_views_are_binary(server: PageServer) -> None:
    with page(server, "picture,views") as connection:
        found: dict[str, bytes] = {}
        while not found.keys() >= {"picture", "views"}:
            found |= update(connection)
    kind, number, grabbed_s = HEADER.unpack_from(found["picture"])
    assert (kind, number > 0, grabbed_s > 0.0) == (PICTURE_KIND, True, True)
    assert found["picture"][HEADER.size :].startswith(b"\xff\xd8")
    _, count, _ = HEADER.unpack_from(found["views"])
    assert count == 10
    assert len(found["views"]) == HEADER.size + count * (VIEW_HEADER.size + 720) < 7500


def test_one_robots_view_comes_with_its_message(server: PageServer) -> None:
    with page(server, "view/blue/3") as connection:
        wait_for(lambda: update(connection)["view/blue/3"]["valid"])
        view = update(connection)["view/blue/3"]
    assert len(base64.b64decode(view["px"])) == len(base64.b64decode(view["kinds"])) == 360
    see = decode_message(view["message"].encode())
    assert isinstance(see, See)
    assert abs(see.time_s - view["grabbed_s"]) < 0.0011
    assert len(see.edges) == 3 * 360


def test_an_overlay_is_drawn_while_somebody_looks_and_no_longer(server: PageServer, service: FakeService) -> None:
    overlays = service.store.reader("overlay/main")
    drawn = overlays.sequence
    with page(server, "status,overlay/hypotheses,overlay/blobs") as connection:
        wait_for(lambda: "overlay/hypotheses" in update(connection))
        found: dict[str, Any] = {}
        while not found.keys() >= {"overlay/hypotheses", "overlay/blobs"}:
            found |= update(connection)
    assert overlays.sequence > drawn
    hypotheses = found["overlay/hypotheses"]
    assert 0.0 < hypotheses["grabbed_s"] <= hypotheses["now_s"]
    assert hypotheses["frame"] > 0
    (rejected,) = [shown for shown in hypotheses["content"]["shown"] if not shown["is_accepted"]]
    assert (rejected["found"], rejected["accepted"]) == ("circle 24 px across", "9 to 18 px")
    assert found["overlay/blobs"]["content"]["count"] == 340
    looking = records.LOOKING.reader(service.store).value(service.clock.now())
    assert looking.layers == ("blobs", "hypotheses")
    wait_for(lambda: looking.until < service.clock.now())
    over = overlays.sequence
    with page(server, "status,world") as connection:
        wait_for(lambda: "world" in update(connection))
    assert overlays.sequence == over


def test_classes_come_as_a_png(server: PageServer) -> None:
    with page(server, "status,overlay/classes") as connection:
        found: dict[str, Any] = {}
        while "overlay/classes" not in found:
            found |= update(connection)
    content = found["overlay/classes"]["content"]
    assert base64.b64decode(content["png"]).startswith(b"\x89PNG")
    assert "orange" in [color["name"] for color in content["colors"]]


def test_the_same_is_not_sent_twice(server: PageServer) -> None:
    with page(server, "world,timing") as connection:
        grabbed = [update(connection)["world"]["grabbed_s"] for _ in range(5)]
        timings = sum("timing" in update(connection) for _ in range(10))
    assert all(before < after for before, after in pairwise(grabbed))
    assert timings <= 3


def test_nothing_comes_unasked_and_then_the_newest(server: PageServer, service: FakeService) -> None:
    with page(server, "world") as connection:
        first = update(connection)["world"]["grabbed_s"]
        before = service.store.reader("world").sequence
        wait_for(lambda: service.store.reader("world").sequence > before + 10)
        with pytest.raises(TimeoutError):
            connection.recv(timeout=0.05)
        assert update(connection)["world"]["grabbed_s"] > first + 0.2


def test_other_topics_are_taken_without_a_new_connection(server: PageServer) -> None:
    with page(server, "status") as connection:
        assert update(connection).keys() == {"status"}
        connection.send(json.dumps({"topics": ["world"]}))
        assert update(connection).keys() == {"world"}
        connection.send(json.dumps({"topics": ["weather"]}))
        assert "found: weather; accepted: status,world" in refused(connection)


@pytest.mark.parametrize("topics", ["weather", "view/red/1", "view/blue/0", "view/blue/6", "view/blue/x", "a" * 5000])
def test_topics_that_do_not_exist_are_refused_in_words(server: PageServer, topics: str) -> None:
    with page(server, topics) as connection:
        assert "accepted: status,world" in refused(connection)


def test_whatever_is_sent_the_service_goes_on(server: PageServer) -> None:
    with page(server, "status") as connection:
        for text in ("", "{", '{"topics": 1}', '{"topics": {"a": 1}}', "[]", "{" * 900):
            connection.send(text)
            connection.recv(timeout=10)
        connection.send(b"\xff\xfe")
        connection.recv(timeout=10)
    with page(server) as connection:
        assert update(connection)


def test_a_page_that_does_not_ask_is_dropped(server: PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "PATIENCE_S", 0.1)
    with page(server) as connection, pytest.raises(ConnectionClosed) as closed:
        connection.recv(timeout=10)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == live.POLICY_VIOLATION


def test_many_pages_of_one_computer_leave_room_for_the_operator(
    server: PageServer, service: FakeService, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "PER_ADDRESS", 2)
    with page(server) as first, page(server) as second:
        update(first)
        update(second)
        with page(server) as third:
            assert "2 pages of your address are open already" in refused(third)
        monkeypatch.setattr(live, "MAX_PAGES", 2)
        with page(server, headers=service.operator) as operator:
            assert update(operator)


def test_messages_are_made_while_somebody_looks(server: PageServer, service: FakeService) -> None:
    info = records.task("web").reader(service.store)
    with page(server, "world") as connection:
        for _ in range(20):
            update(connection)
        wait_for(lambda: update(connection) and info.value(service.clock.now()).note == "1 page open")
    wait_for(lambda: info.value(service.clock.now()).note == "0 pages open")
    runs = info.value(service.clock.now()).runs
    sequence = info.sequence
    wait_for(lambda: info.sequence >= sequence + 2)
    assert info.value(service.clock.now()).runs <= runs + 1


def ended_login(connection: Connection) -> tuple[int, str]:
    """Code and reason with which a connection is closed while it only listens."""
    with pytest.raises(ConnectionClosed) as closed:
        connection.recv(timeout=3)
    assert closed.value.rcvd is not None
    return closed.value.rcvd.code, closed.value.rcvd.reason


LOGIN_ENDED = (live.POLICY_VIOLATION, "your login has ended: log in again")


def logged_in(server: PageServer, secret: str) -> dict[str, str]:
    """Headers with the cookie of a new session."""
    answer = httpx.post(f"http://{server.address}/api/v1/login", json={"secret": secret})
    return {"cookie": answer.headers["set-cookie"].partition(";")[0]}


def test_a_revoked_token_ends_its_connections(server: PageServer, service: FakeService) -> None:
    people = People(service.people)
    token, secret = people.new_token("scoreboard")
    with (
        page(server, headers={"authorization": f"Bearer {secret}"}) as connection,
        page(server, headers=service.operator) as other,
    ):
        update(connection)
        people.revoke_token(token.id)  # as `pslv token --revoke` does, in another process
        assert ended_login(connection) == LOGIN_ENDED
        assert update(other)
    people.close()


@pytest.mark.parametrize("ending", ["logout", "password", "team key"])
def test_a_login_that_ends_ends_its_connections(server: PageServer, service: FakeService, ending: str) -> None:
    people = People(service.people)
    if ending == "team key":
        headers = logged_in(server, people.team_keys.renew("cgn"))
    else:
        people.set_password(Role.OPERATOR, "a long password")
        headers = logged_in(server, "a long password")
    with page(server, headers=headers) as connection:
        update(connection)
        if ending == "logout":
            assert httpx.post(f"http://{server.address}/api/v1/logout", headers=headers).is_success
        elif ending == "password":
            people.set_password(Role.OPERATOR, "another password")
        else:
            people.team_keys.renew("cgn")
        assert ended_login(connection) == LOGIN_ENDED
    people.close()


def test_a_server_that_stops_closes_its_pages(service: FakeService) -> None:
    server = PageServer(service)
    server.start()
    with page(server) as connection:
        update(connection)
        server.stop()
        with pytest.raises(ConnectionClosed):
            update(connection)


def test_in_a_match_viewers_see_late_operators_at_once_and_teams_their_own_robots(
    server: PageServer, service: FakeService
) -> None:
    def changed(path: str, body: dict[str, Any], method: str = "PATCH") -> None:
        answer = httpx.request(method, f"http://{server.address}/api/v1{path}", json=body, headers=service.operator)
        assert answer.is_success, answer.text

    changed("/teams", TEAM, "POST")
    changed("/match", {"blue": "cgn", "mode": "match", "viewer_delay_s": 1.0})
    people = People(service.people)
    key = people.team_keys.renew("cgn")
    people.close()
    login = httpx.post(f"http://{server.address}/api/v1/login", json={"secret": key})
    team = {"cookie": login.headers["set-cookie"].partition(";")[0]}
    try:
        with page(server, "world,picture,overlay/blobs") as viewer, page(server, "world", service.operator) as operator:
            for _ in range(5):
                at_once = update(operator)["world"]
                assert at_once["now_s"] - at_once["grabbed_s"] < 0.9
            late = update(viewer)
            world = late["world"]
            end_s = update(operator)["world"]["now_s"]
            assert 0.9 < end_s - world["grabbed_s"] < 2.5
            if "picture" in late:
                assert end_s - HEADER.unpack_from(late["picture"])[2] > 0.9
            while "overlay/blobs" not in late:
                late |= update(viewer)
            assert update(operator)["world"]["now_s"] - late["overlay/blobs"]["grabbed_s"] > 0.9
        with page(server, "status,view/blue/2", team) as own:
            view = update(own).get("view/blue/2") or update(own)["view/blue/2"]
            assert view["now_s"] - view["grabbed_s"] < 0.9
        for foreign in ("view/yellow/2", "world", "picture", "overlay/blobs"):
            with page(server, foreign, team) as other:
                assert "is not for your team" in refused(other)
        with page(server, "view/blue/2", team) as own:
            update(own)
            changed("/match", {"blue": None})
            assert "is not for your team" in refused(own)
    finally:
        changed("/match", {"blue": None, "mode": "practice", "viewer_delay_s": 5.0})
        httpx.delete(f"http://{server.address}/api/v1/teams/cgn", headers=service.operator)
