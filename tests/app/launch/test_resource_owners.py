"""Who holds a port, a device or a camera."""

import os
import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.launch.resource_owners import device_holder, lock_camera, port_holder
from tests.conftest import ROOT
from vision_core.errors import ServiceError

HOLDING = """
import os, socket, sys
from app.launch.resource_owners import lock_camera
page, robots = socket.socket(socket.AF_INET6), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
page.bind(("::1", 0))
page.listen(1)
robots.bind(("127.0.0.1", 0))
device = open(sys.argv[1])
lock = lock_camera(sys.argv[1])
if os.fork():
    print(page.getsockname()[1], robots.getsockname()[1], flush=True)
sys.stdin.read()
"""


class Holder:
    """A process that holds a TCP and a UDP port, a file and a camera's lock; and a child that inherited them."""

    def __init__(self, device: Path) -> None:
        self.device = str(device)
        self.process = subprocess.Popen(
            [sys.executable, "-c", HOLDING, self.device],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        self.tcp, self.udp = map(int, self.process.stdout.readline().split())
        self.words = rf"process {self.process.pid} \(python\S* -c .*"

    def close(self) -> None:
        self.process.communicate()


@pytest.fixture(scope="module")
def holder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Holder]:
    device = tmp_path_factory.mktemp("dev") / "video0"
    device.touch()
    started = Holder(device)
    yield started
    started.close()


def test_the_process_behind_a_port_is_named(holder: Holder) -> None:
    for kind, port in (("tcp", holder.tcp), ("udp", holder.udp)):
        found = port_holder(kind, port)
        assert found is not None
        assert re.fullmatch(holder.words, found)


def test_a_free_port_has_no_holder() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        assert port_holder("tcp", taken.getsockname()[1]) is None  # bound, but it does not listen


def test_the_process_behind_a_device_is_named_but_never_ourselves(holder: Holder, tmp_path: Path) -> None:
    found = device_holder(holder.device)
    assert found is not None
    assert re.fullmatch(holder.words, found)
    with (tmp_path / "ours").open("w") as ours:
        assert device_holder(ours.name) is None


def test_a_camera_has_one_service(holder: Holder, tmp_path: Path) -> None:
    link = tmp_path / "by-id"
    link.symlink_to(holder.device)
    with pytest.raises(ServiceError, match=rf"camera .*video0; found: {holder.words} holds it; accepted: "):
        lock_camera(str(link))


def test_a_lock_ends_with_its_socket(tmp_path: Path) -> None:
    device = str(tmp_path / "video1")
    for _ in range(2):
        with lock_camera(device), pytest.raises(ServiceError, match=rf"process {os.getpid()} .*holds it"):
            lock_camera(device)
        lock_camera(device).close()


def test_a_camera_may_be_called_by_its_number() -> None:
    number = "9731"
    with lock_camera(number), pytest.raises(ServiceError, match=f"camera /dev/video{number}"):
        lock_camera(f"/dev/video{number}")


def test_a_name_that_is_too_long_is_refused() -> None:
    with pytest.raises(ServiceError, match="camera /dev/xx.*too long"):
        lock_camera("/dev/" + "x" * 200)
