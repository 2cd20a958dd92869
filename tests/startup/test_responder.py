"""The process that answers clients while the task serve does not run."""

import os
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import pytest

from vision_core.clock import Instant, MonotonicClock
from vision_core.net.not_ready import NOT_READY
from vision_core.net.udp import open_server_sockets
from vision_core.rtdb import records
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.store import Store, create_block
from vision_core.startup import responder

CLOCK = MonotonicClock()


def test_the_record_is_the_one_that_serve_writes() -> None:
    assert records.SERVING.spec.name == responder.SERVING


@dataclass
class Resources:
    sockets: dict[str, int]


@dataclass
class FakeAttachment:
    """As ``Attachment``, with a database of one record."""

    resources: Resources
    store: Store
    main: socket.socket
    stopping: bool = False
    heartbeats: list[Instant] = field(default_factory=list)

    def heartbeat(self, now: Instant) -> None:
        self.heartbeats.append(now)


@pytest.fixture
def attachment(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeAttachment]:
    main, session = open_server_sockets("127.0.0.1", 0, 0)
    specs = (RecordSpec(responder.SERVING, 8, 0.3),)
    block = create_block(specs)
    sockets = {name: socket.dup(opened.fileno()) for name, opened in (("main", main), ("session", session))}
    fake = FakeAttachment(Resources(sockets), Store(specs, block), main)
    monkeypatch.setattr(responder, "attach", lambda: fake)
    thread = threading.Thread(target=responder.main)
    thread.start()
    with main, session:
        yield fake
        fake.stopping = True
        thread.join()
    fake.store.close()
    os.close(block)


def ask(attachment: FakeAttachment) -> bytes:
    """What an init gets within half a second."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.settimeout(0.5)
        client.sendto(b"(init blue 3)", attachment.main.getsockname())
        try:
            return client.recv(100)
        except TimeoutError:
            return b""


def test_it_answers_until_serve_runs_and_again_when_serve_has_stopped(attachment: FakeAttachment) -> None:
    assert ask(attachment) == NOT_READY
    writer = attachment.store.writer(responder.SERVING)
    stop = threading.Event()

    def serve() -> None:
        while not stop.is_set():
            writer.write(b"", CLOCK.now(), CLOCK.now())
            time.sleep(0.02)

    thread = threading.Thread(target=serve)
    thread.start()
    time.sleep(3 * responder.TURN_S)
    assert ask(attachment) == b""
    assert attachment.main.recv(100) == b"(init blue 3)"  # it is left for serve
    stop.set()
    thread.join()
    while (answer := ask(attachment)) == b"":
        pass
    assert answer == NOT_READY
    assert len(attachment.heartbeats) > 3
