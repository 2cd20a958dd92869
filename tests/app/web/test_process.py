"""The process itself, started as the supervisor starts it."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest
from websockets.sync.client import connect

from tests.app.fake_service import FakeService, wait_for
from vision_core.rtdb import records
from vision_core.scheduling.attachment import VARIABLE, ChildResources

pytestmark = pytest.mark.slow


@contextmanager
def web_process(service: FakeService, listener: socket.socket) -> Iterator[subprocess.Popen[bytes]]:
    """``python -m app.web.process`` on a database and a socket."""
    handed = ChildResources(
        process="web",
        supervisor=os.getpid(),
        boot=service.boot,
        block=service.block,
        records=service.specs,
        wake=None,
        notify={},
        sockets={"http": listener.fileno()},
    )
    environment = os.environ | {VARIABLE: handed.encode()}
    command = [sys.executable, "-m", "app.web.process"]
    with subprocess.Popen(command, env=environment, pass_fds=handed.descriptors(), stderr=subprocess.PIPE) as process:
        try:
            yield process
        finally:
            process.kill()


def test_it_serves_beats_and_ends_with_an_open_page() -> None:
    service = FakeService()
    service.write_processes()
    service.write_frame()
    beats = records.task("web").reader(service.store)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        address = f"127.0.0.1:{listener.getsockname()[1]}"
        with web_process(service, listener) as process:
            wait_for(lambda: beats.sequence > 0)
            assert beats.value(service.clock.now()).pid == process.pid
            with connect(f"ws://{address}/live", proxy=None) as page:
                page.send("next")
                page.recv(timeout=10)
                process.send_signal(signal.SIGTERM)
                process.wait(timeout=10)
            assert process.stderr is not None
            assert b"Traceback" not in process.stderr.read()
        with web_process(service, listener) as process:  # started again on the same socket
            assert httpx.get(f"http://{address}/healthz", timeout=20).status_code == 200


def test_it_is_a_part_of_the_service() -> None:
    environment = {key: value for key, value in os.environ.items() if key != VARIABLE}
    ended = subprocess.run([sys.executable, "-m", "app.web.process"], env=environment, capture_output=True, check=False)
    assert ended.returncode != 0
    assert b"pslv serve" in ended.stderr
