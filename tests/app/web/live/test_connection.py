"""The live connection: one turn under way at most, always the newest."""

import base64
import json
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect
from websockets.sync.connection import Connection

from app.web.live import connection as live
from app.web.live import messages as turns
from tests.app.fake_service import FakeService, PageServer, wait_for
from vision_core.rtdb import records


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


def page(server: PageServer, origin: str | None = None, query: str = "") -> Connection:
    headers = {} if origin is None else {"Origin": origin}
    return connect(f"ws://{server.address}/live{query}", additional_headers=headers, proxy=None)


def turn(connection: Connection) -> tuple[bytes | None, dict[str, Any]]:
    """Ask for a turn: the picture message if there is one, and the state."""
    connection.send("next")
    picture = None
    while isinstance(message := connection.recv(timeout=10), bytes):
        picture = message
    return picture, json.loads(message)


def test_a_turn_is_a_picture_and_a_state(server: PageServer, service: FakeService) -> None:
    with page(server) as connection:
        picture, state = turn(connection)
        wait_for(lambda: turn(connection)[1]["status"]["ready"])
    assert picture is not None
    number, grabbed_s = turns.PICTURE_HEADER.unpack_from(picture)
    assert number > 0
    assert 0.0 < grabbed_s <= state["now_s"]
    assert picture[turns.PICTURE_HEADER.size :].startswith(b"\xff\xd8")
    assert state["pages"] == 1
    assert len(state["outlines_px"]) == len(state["sightings"]["value"]["robots"]) == 10
    assert len(state["obstacle_outlines_px"]) == len(state["obstacles"]["value"]["obstacles"]) == 2
    assert [thing["radius_m"] for thing in state["world"]["value"]["obstacles"]] == [0.11, 0.06]
    views = state["views"]["value"]["views"]
    assert len(views) == 10
    assert len(base64.b64decode(views[0]["px"])) == len(base64.b64decode(views[0]["kinds"])) == 360


def test_nothing_comes_unasked_and_then_the_newest(server: PageServer, service: FakeService) -> None:
    with page(server) as connection:
        first, _ = turn(connection)
        assert first is not None
        shown = turns.PICTURE_HEADER.unpack_from(first)[0]
        wait_for(lambda: service.store.reader("frames/main").sequence > shown + 10)
        with pytest.raises(TimeoutError):
            connection.recv(timeout=0.05)
        later, _ = turn(connection)
    assert later is not None
    assert turns.PICTURE_HEADER.unpack_from(later)[0] > shown + 5


@pytest.mark.slow
def test_turns_stop_when_nobody_watches(server: PageServer, service: FakeService) -> None:
    info = records.task("web").reader(service.store)
    with page(server) as connection:
        for _ in range(3):
            turn(connection)
        wait_for(lambda: info.value(service.clock.now()).response_max_ms > 0.0)
        assert info.value(service.clock.now()).note == "1 page open"
    wait_for(lambda: info.value(service.clock.now()).note == "0 pages open")
    sequence = info.sequence
    wait_for(lambda: info.sequence >= sequence + 2)
    assert info.value(service.clock.now()).response_max_ms == 0.0


def test_a_page_that_does_not_ask_is_dropped(server: PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "PATIENCE_S", 0.1)
    with page(server) as connection:
        with pytest.raises(ConnectionClosed) as closed:
            connection.recv(timeout=10)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == live.POLICY_VIOLATION


def test_one_page_too_many_is_refused_with_a_reason(server: PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "MAX_PAGES", 1)
    with page(server) as first:
        turn(first)
        with page(server) as second, pytest.raises(ConnectionClosed) as closed:
            second.recv(timeout=10)
        turn(first)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == live.TRY_LATER
    assert "1 pages are open" in closed.value.rcvd.reason


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1"])
def test_foreign_pages_are_refused(server: PageServer, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused:
        page(server, origin)
    assert refused.value.response.status_code == 403


def test_our_own_page_is_let_in(server: PageServer) -> None:
    with page(server, f"http://{server.address}") as connection:
        turn(connection)


def test_a_server_that_stops_closes_its_pages(service: FakeService) -> None:
    server = PageServer(service)
    server.start()
    with page(server) as connection:
        turn(connection)
        server.stop()
        with pytest.raises(ConnectionClosed):
            turn(connection)


def test_any_message_asks_for_a_turn(server: PageServer) -> None:
    with page(server) as connection:
        connection.send(b"next")
        assert connection.recv(timeout=10)


def test_topics_come_in_their_order_and_end_with_the_last(server: PageServer) -> None:
    with page(server, query="?topics=state,timing,picture") as connection:
        connection.send("next")
        picture, timing, state = (connection.recv(timeout=10) for _ in range(3))
        with pytest.raises(TimeoutError):
            connection.recv(timeout=0.1)
    assert isinstance(picture, bytes)
    assert [json.loads(message)["topic"] for message in (timing, state)] == ["timing", "state"]


@pytest.mark.slow
def test_timing_alone_comes_twice_a_second_at_most(server: PageServer, service: FakeService) -> None:
    with page(server, query="?topics=timing") as connection:
        turns_told = [turn(connection) for _ in range(3)]
    assert all(picture is None for picture, _ in turns_told)
    instants_s = [told["now_s"] for _, told in turns_told]
    assert all(later - now >= turns.TIMING_EVERY_S for now, later in pairwise(instants_s))
    tasks = {task["name"]: task for task in turns_told[-1][1]["tasks"]}
    assert set(tasks) == {task.name for task in service.tasks}
    timing = turns_told[-1][1]["timing"]
    assert {task["name"] for task in timing["tasks"]} == set(tasks), "the page's own times too"
    assert timing["lags"]["server"]["count"] > 0


def test_unknown_topics_are_refused_with_those_there_are(server: PageServer) -> None:
    with page(server, query="?topics=state,weather") as connection, pytest.raises(ConnectionClosed) as closed:
        connection.recv(timeout=10)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.reason == "topics; found: state,weather; accepted: picture,timing,state"


def test_what_nobody_takes_is_not_made(server: PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(turns, "picture_message", lambda *_: pytest.fail("nobody takes pictures"))
    with page(server, query="?topics=state") as connection:
        for _ in range(3):
            picture, state = turn(connection)
            assert picture is None
            assert state["topic"] == "state"


def test_who_waits_for_what_does_not_come_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "PATIENCE_S", 0.3)
    server = PageServer(FakeService())
    server.start()
    with page(server, query="?topics=picture") as connection:
        connection.send("next")
        with pytest.raises(ConnectionClosed) as closed:
            connection.recv(timeout=10)
    server.stop()
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.reason.startswith("there was no picture for")
