"""The 3D view behind the page's port: who gets in, what is sent, and that nothing is computed without a viewer."""

import socket
import time
from collections.abc import Iterator

import httpx
import msgspec
import pytest
import viser
import zstandard
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Subprotocol

from app.web.view3d.server import SECRET_HEADER, GuardedServer
from tests.app.fake_service import FakeService, PageServer, Scene, wait_for

pytestmark = pytest.mark.slow
HEADER_BYTES = 16
"""Of a message of viser: its size before and after compression."""
PROTOCOL = Subprotocol(f"viser-v{viser.__version__}")


@pytest.fixture(scope="module")
def server() -> Iterator[PageServer]:
    service = FakeService(Scene())
    service.start()
    server = PageServer(service)
    server.start()
    wait_for(lambda: httpx.get(f"http://{server.address}/healthz").status_code == 200)
    yield server
    server.stop()
    service.stop()


def looking(server: PageServer, path: str = "view3d", **options: object) -> Connection:
    return connect(
        f"ws://{server.address}/{path}",
        subprotocols=[PROTOCOL],
        max_size=None,
        proxy=None,
        **options,  # type: ignore[arg-type]
    )


def received(page: Connection, seconds: float) -> bytes:
    """Everything that comes within a time."""
    end, content = time.monotonic() + seconds, b""
    while (left_s := end - time.monotonic()) > 0.0:
        try:
            message = page.recv(timeout=left_s)
        except TimeoutError:
            break
        assert isinstance(message, bytes)
        content += zstandard.ZstdDecompressor().decompress(message[HEADER_BYTES:])
    return content


def test_nobody_reaches_viser_without_the_secret() -> None:
    guarded = GuardedServer()
    try:
        for headers in ({}, {SECRET_HEADER: "guessed"}):
            with pytest.raises(InvalidStatus, match="403"):
                connect(guarded.address, subprotocols=[PROTOCOL], additional_headers=headers, proxy=None)
        page = f"http://{guarded.address.removeprefix('ws://')}"
        assert httpx.get(page).status_code == 403
        with connect(
            guarded.address, subprotocols=[PROTOCOL], additional_headers={SECRET_HEADER: guarded.secret}, proxy=None
        ) as page_:
            assert page_.subprotocol == PROTOCOL
    finally:
        guarded.stop()


def test_viser_listens_on_the_loopback_interface_alone() -> None:
    guarded = GuardedServer()
    try:
        port = guarded.viser.get_port()
        with socket.socket() as other:
            other.settimeout(1.0)
            assert other.connect_ex(("127.0.0.2", port)) != 0
    finally:
        guarded.stop()


@pytest.mark.parametrize("path", ["view3d", "view3d/"])
def test_a_viewer_is_sent_the_scene(server: PageServer, path: str) -> None:
    with looking(server, path) as page:
        scene = received(page, 5.0)
    for node in (
        b"/field/carpet",
        b"/field/lines",
        b"/cameras/main",
        b"/robots/blue id 1/body",
        b"/ball/ball",
        b"/edges",
    ):
        assert node in scene


def test_the_page_is_served_with_a_policy_of_its_own(server: PageServer) -> None:
    answer = httpx.get(f"http://{server.address}/view3d/")
    assert answer.status_code == 200
    assert "frame-ancestors 'self'" in answer.headers["content-security-policy"]
    assert "connect-src 'self'" in answer.headers["content-security-policy"]


def test_a_foreign_page_gets_no_connection(server: PageServer) -> None:
    with pytest.raises(InvalidStatus, match="403"):
        looking(server, origin="http://evil.example")


def test_another_version_of_the_page_is_told_so(server: PageServer) -> None:
    with connect(f"ws://{server.address}/view3d", subprotocols=[Subprotocol("viser-v0.0.1")], proxy=None) as page:
        with pytest.raises(ConnectionClosed):
            page.recv(timeout=5.0)
        assert PROTOCOL in str(page.protocol.close_reason)


def test_a_tunnel_through_the_internet_is_not_opened(server: PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[object] = []
    monkeypatch.setattr(viser.ViserServer, "request_share_url", lambda *_args, **_options: asked.append(1))
    with looking(server) as page:
        received(page, 1.0)
        page.send(msgspec.msgpack.encode([{"type": "ShareUrlRequest"}]))
        received(page, 1.0)
    assert not asked


def test_a_fifth_viewer_is_asked_to_come_later(server: PageServer) -> None:
    pages = [looking(server) for _ in range(4)]
    try:
        with connect(f"ws://{server.address}/view3d", subprotocols=[PROTOCOL], proxy=None) as page:
            with pytest.raises(ConnectionClosed):
                page.recv(timeout=5.0)
            assert "4 people look" in str(page.protocol.close_reason)
    finally:
        for page in pages:
            page.close()
