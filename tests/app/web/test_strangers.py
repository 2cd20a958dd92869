"""What strangers can hold open and order: connections, requests, answers, log lines."""

import asyncio
import contextlib
import http.client
import json
import logging
import os
import socket
import threading
import time
from collections.abc import Iterator

import httpx
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from app.web import cached, connections, log_output
from app.web.auth.addresses import plain_address, share_of
from app.web.auth.attempts import FORGET_ONE_S, OVERALL, TRIES, Attempts
from app.web.closing import MAX_REASON, short
from app.web.connections import OperatorAddresses, has_room
from app.web.live import connection as live
from tests.app.fake_service import FakeService, Scene, running_service, served_page

HALF_A_REQUEST = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Long: "
HALF_A_BODY = (
    b"POST /api/v1/login HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\nContent-Length: 99\r\n\r\n{"
)


class Clock:
    """A clock that stands still until it is moved."""

    now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    with running_service(Scene(clients=1)) as service:
        yield service


@pytest.fixture
def address(service: FakeService) -> Iterator[str]:
    with served_page(service) as address:
        yield address


def opened(address: str, sent: bytes = b"", source: str = "127.0.0.1") -> socket.socket:
    host, _, port = address.rpartition(":")
    stranger = socket.create_connection((host, int(port)), timeout=20, source_address=(source, 0))
    stranger.sendall(sent)
    return stranger


def is_closed(stranger: socket.socket) -> bool:
    try:
        return stranger.recv(1) == b""
    except ConnectionError:
        return True


@pytest.mark.parametrize("sent", [b"", HALF_A_REQUEST, HALF_A_BODY])
def test_half_a_request_is_waited_for_only_shortly(address: str, monkeypatch: pytest.MonkeyPatch, sent: bytes) -> None:
    monkeypatch.setattr(connections, "REQUEST_S", 0.2)
    with opened(address, sent) as stranger:
        assert is_closed(stranger)


def test_a_slow_byte_now_and_then_gains_no_time(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "REQUEST_S", 0.5)
    began_s = time.monotonic()
    with opened(address, HALF_A_REQUEST) as stranger, contextlib.suppress(ConnectionError):
        while time.monotonic() - began_s < 10.0:
            stranger.sendall(b"a")
            time.sleep(0.05)
    assert time.monotonic() - began_s < 10.0


def test_between_requests_a_connection_may_rest(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "REQUEST_S", 0.2)
    with httpx.Client(base_url=f"http://{address}", transport=httpx.HTTPTransport(retries=0)) as http_client:
        for _ in range(2):
            assert http_client.get("/healthz").status_code == 200
            time.sleep(0.5)
    with connect(f"ws://{address}/live?topics=status", proxy=None) as page:
        time.sleep(0.5)
        page.send("next")
        assert page.recv(timeout=10)


def test_one_address_takes_its_share_and_no_more(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "PER_ADDRESS", 3)
    strangers = [opened(address, HALF_A_REQUEST, "127.0.0.9") for _ in range(3)]
    with opened(address, b"", "127.0.0.9") as one_more:
        assert is_closed(one_more)
    assert httpx.get(f"http://{address}/healthz").status_code == 200, "another address is served"
    for stranger in strangers:
        stranger.close()


def test_the_operator_finds_room_when_strangers_have_theirs() -> None:
    class Held:
        def __init__(self, client: str) -> None:
            self.client = (client, 1)

    taken = {Held(f"10.0.{n // 200}.{n % 200}") for n in range(connections.MAX_CONNECTIONS)}
    operators = OperatorAddresses()
    few = set(list(taken)[: connections.MAX_CONNECTIONS - connections.FOR_OPERATORS + 1])
    assert not has_room(("192.168.1.2", 1), few, operators)
    operators.note("::ffff:192.168.1.2")
    assert has_room(("192.168.1.2", 1), few, operators)


def test_a_share_is_an_address_or_an_ipv6_network() -> None:
    assert plain_address("::ffff:10.1.2.3") == share_of("::ffff:10.1.2.3") == "10.1.2.3"
    assert share_of("2001:db8::1") == share_of("2001:db8::ffff:1") != share_of("2001:db8:0:1::1")
    assert share_of("fe80::1%eth0") == "fe80::/64"
    assert share_of("nobody") == "nobody"


def test_many_questions_are_one_answer() -> None:
    made = []

    def make() -> bytes:
        made.append(threading.current_thread())
        time.sleep(0.05)
        return b"answer"

    async def ask() -> list[bytes]:
        answers = cached.Cached(make, 10.0)
        return await asyncio.gather(*(answers.get() for _ in range(50)))

    assert asyncio.run(ask()) == [b"answer"] * 50
    assert len(made) == 1
    assert made[0] is not threading.main_thread()


@pytest.mark.parametrize("path", ["/api/v1/status", "/api/v1/timing", "/metrics"])
def test_costly_answers_are_made_once_for_all(address: str, path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with httpx.Client(base_url=f"http://{address}") as asking:
        assert len({asking.get(path).content for _ in range(20)}) < 20


def test_too_many_requests_at_a_time_are_asked_to_come_again(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from app.web.middleware import under_way

    monkeypatch.setattr(under_way, "WAITING_PER_ADDRESS", 1)
    host, _, port = address.rpartition(":")
    with opened(address, HALF_A_BODY):
        time.sleep(0.3)
        busy = http.client.HTTPConnection(host, int(port))
        busy.request("GET", "/api/v1/status")
        answer = busy.getresponse()
        assert (answer.status, answer.headers["retry-after"]) == (503, "1")
        assert json.loads(answer.read())["detail"] == "too many requests at a time"
        busy.close()


def test_strangers_do_not_take_the_operators_page(
    address: str, service: FakeService, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "MAX_PAGES", 2)
    url = f"ws://{address}/live?topics=status"
    with connect(url, proxy=None) as one, connect(url, proxy=None) as two:
        for page in (one, two):
            page.send("next")
            page.recv(timeout=10)
        with connect(url, proxy=None) as third, pytest.raises(ConnectionClosed):
            third.recv(timeout=10)
        with connect(url, proxy=None, additional_headers=service.operator) as operator:
            operator.send("next")
            assert operator.recv(timeout=10)


def test_one_address_does_not_take_every_page(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "PER_ADDRESS", 1)
    url = f"ws://{address}/live?topics=status"
    with connect(url, proxy=None) as one:
        one.send("next")
        one.recv(timeout=10)
        with connect(url, proxy=None) as second, pytest.raises(ConnectionClosed) as closed:
            second.recv(timeout=10)
        assert closed.value.rcvd is not None
        assert "of your address" in closed.value.rcvd.reason
        with opened(address, source="127.0.0.7") as other, connect(url, sock=other, proxy=None) as elsewhere:
            elsewhere.send("next")
            assert elsewhere.recv(timeout=10)


@pytest.mark.parametrize("reason", ["a" * 500, "ä" * 500, "\N{SOCCER BALL}" * 500, "short"])
def test_reasons_fit_into_a_frame(reason: str) -> None:
    assert len(short(reason).encode()) <= MAX_REASON
    assert reason.startswith(short(reason))


def test_a_long_strange_topic_and_a_page_that_leaves_make_no_trace(
    address: str, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    with (
        connect(f"ws://{address}/live?topics={'%E2%9A%BD' * 200}", proxy=None) as page,
        pytest.raises(ConnectionClosed),
    ):
        page.recv(timeout=10)
    monkeypatch.setattr(live, "PATIENCE_S", 0.1)
    with connect(f"ws://{address}/live", proxy=None) as page:
        page.socket.close()
    time.sleep(0.4)
    assert not [record for record in caplog.records if record.exc_info and record.name != "websockets.client"]


def test_redirects_stay_here_and_head_works(address: str) -> None:
    moved = httpx.get(f"http://{address}/web", headers={"host": "localhost"})
    assert moved.headers["location"] == "/web/"
    for path in ("/", "/healthz", "/api/v1/status", "/metrics", "/docs"):
        answer = httpx.head(f"http://{address}{path}")
        assert (answer.status_code, answer.content) == (200, b""), path


def test_little_of_a_request_is_sent_back(address: str) -> None:
    assert len(httpx.get(f"http://{address}/api/v1/{'a' * 9000}").content) < 1500
    host = httpx.get(f"http://{address}/", headers={"host": "a" * 9000})
    assert len(host.content) < 1500
    assert len(httpx.get(f"http://{address}/{'a' * 60000}").content) < 1500


def test_forwarded_addresses_are_not_believed(address: str, service: FakeService) -> None:
    with httpx.Client(base_url=f"http://{address}", headers={"x-forwarded-for": "10.9.9.9"}) as stranger:
        stranger.post("/api/v1/login", json={"secret": "guessed"})
    entries = httpx.get(f"http://{address}/api/v1/audit", headers=service.operator).json()
    assert "10.9.9.9" not in {entry["address"] for entry in entries}


def test_own_failures_keep_an_address_out_and_only_they() -> None:
    clock = Clock()
    attempts = Attempts(clock)
    for _ in range(TRIES):
        assert attempts.wait_s("a") == 0.0
        attempts.begin("a")
    assert attempts.wait_s("a") == FORGET_ONE_S
    clock.now_s += FORGET_ONE_S / 2
    assert attempts.wait_s("a") > 0.0
    clock.now_s += FORGET_ONE_S / 2
    assert attempts.wait_s("a") == 0.0
    for n in range(int(OVERALL) + TRIES):
        attempts.begin(f"stranger {n}")
    assert attempts.wait_s("stranger 1") > 0.0, "under attack one try is all"
    assert attempts.wait_s("b") == 0.0, "who has not failed may try"


def test_the_log_is_bounded_and_waits_for_nobody() -> None:
    reading, writing = os.pipe()
    handler = log_output.BoundedHandler(writing)
    log = logging.Logger("stranger")
    log.addHandler(handler)
    for _ in range(10 * log_output.LINES):
        log.warning("a" * 100_000)
    os.set_blocking(reading, False)
    told = os.read(reading, 1 << 20)
    assert 0 < len(told) <= log_output.LINES * (log_output.MAX_BYTES + 1)
    handler._began_s -= log_output.PERIOD_S
    log.warning("later")
    assert b"more lines" in os.read(reading, 1 << 20)
    os.close(reading)
    os.close(writing)
