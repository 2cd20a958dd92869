"""Both sides of the control socket."""

import contextlib
import json
import mmap
import os
import select
import socket
import stat
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import pytest

from app.supervisor import control as server
from vision_core.clock import Instant, MonotonicClock, seconds_between
from vision_core.errors import ServiceError
from vision_core.net import control_files
from vision_core.net.control import Attached, attach_to, restart, running_services
from vision_core.net.control_files import names, path_for, paths_of
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.store import Store, create_block

SPECS = (RecordSpec("one", 16, 0.0), RecordSpec("other", 16, 0.0))
NAME = f"pslv/test-control-{os.getpid()}"
CLOCK = MonotonicClock()


class ControlThread:
    """A control socket over a block of memory, in a thread."""

    def __init__(self) -> None:
        self.block = create_block(SPECS)
        self.to_look_at = os.open(f"/proc/self/fd/{self.block}", os.O_RDONLY)
        self.store = Store(SPECS, self.block)
        self.asked: list[object] = []
        self.socket = server.ControlSocket(NAME, self.answer)
        self.ending = os.eventfd(0)
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def answer(self, request: object) -> server.Answer:
        self.asked.append(request)
        if request == {"do": "attach"}:
            records = [asdict(spec) for spec in SPECS]
            return {"boot": 7, "records": records, "control": NAME}, (self.to_look_at,)
        return {"error": "no such request", "accepted": "attach"}, ()

    def run(self) -> None:
        while True:
            ready, _, _ = select.select([self.ending, *self.socket.descriptors(CLOCK.now())], [], [], 0.05)
            if self.ending in ready:
                return
            for descriptor in ready:
                self.socket.serve(descriptor, CLOCK.now())
            self.socket.close_slow(CLOCK.now())

    def close(self) -> None:
        os.eventfd_write(self.ending, 1)
        self.thread.join()
        self.socket.close()
        self.store.close()
        for descriptor in (self.block, self.to_look_at, self.ending):
            os.close(descriptor)


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> Iterator[ControlThread]:
    monkeypatch.setattr(server, "PATIENCE_S", 0.2)
    service = ControlThread()
    yield service
    service.close()


def connected() -> socket.socket:
    peer = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    peer.settimeout(10.0)
    peer.connect(str(path_for(NAME)))
    return peer


def heard(peer: socket.socket) -> bytes:
    """Everything until the other side hangs up."""
    text = b""
    with contextlib.suppress(ConnectionResetError):
        while more := peer.recv(4096):
            text += more
    return text


def test_several_readers_read_what_is_written(served: ControlThread) -> None:
    first, second = attach_to(NAME), attach_to(NAME)
    served.store.writer("other").write(b"value", CLOCK.now(), CLOCK.now())
    for attached in (first, second):
        reading = attached.store.reader("other").read(CLOCK.now())
        assert reading is not None
        assert reading.value == b"value"
        assert (attached.name, attached.pid, attached.boot) == (NAME, os.getpid(), 7)
        assert attached.runs()
        attached.close()


def test_a_reader_cannot_write(served: ControlThread) -> None:
    attached = attach_to(NAME)
    with pytest.raises(ValueError, match="'one': the block is mapped read-only"):
        attached.store.writer("one")
    attached.close()
    with connected() as peer:
        peer.sendall(b'{"do": "attach"}\n')
        _, descriptors, _, _ = socket.recv_fds(peer, 4096, 1)
    with pytest.raises(PermissionError):
        mmap.mmap(descriptors[0], mmap.PAGESIZE)
    os.close(descriptors[0])


def test_a_reader_notices_the_end_of_the_service() -> None:
    block = create_block(SPECS)
    with subprocess.Popen(["sleep", "60"]) as supervisor:
        attached = Attached(NAME, Store(SPECS, block), supervisor.pid, Instant(7))
        os.close(block)
        assert attached.runs()
        supervisor.kill()
        supervisor.wait()
        assert not attached.runs()
        attached.close()


@pytest.mark.parametrize("said", [b"\n", b"{}\n", b"null\n", b"\xff\0\x01\n", b"[" * 2000 + b"\n", b'{"do": 1}\n'])
def test_garbage_is_answered_and_does_no_harm(served: ControlThread, said: bytes) -> None:
    with connected() as peer:
        peer.sendall(said)
        assert json.loads(heard(peer)) == {"error": "no such request", "accepted": "attach"}
    attach_to(NAME).close()


def test_an_endless_line_is_cut_off(served: ControlThread) -> None:
    with connected() as peer:
        with contextlib.suppress(OSError):
            peer.sendall(b"x" * 100_000)
        assert heard(peer) == b""
    attach_to(NAME).close()
    assert served.asked == [{"do": "attach"}]


def test_a_silent_connection_is_closed_and_others_get_their_turn(served: ControlThread) -> None:
    silent = [connected() for _ in range(server.MAX_CONNECTIONS + 2)]
    attach_to(NAME).close()
    for peer in silent:
        assert heard(peer) == b""
        peer.close()


def test_a_connection_that_is_closed_early_does_no_harm(served: ControlThread) -> None:
    for said in (b"", b'{"do"', b'{"do": "attach"}\n'):
        with connected() as peer:
            peer.sendall(said)
    attach_to(NAME).close()


def test_a_refusal_says_what_was_asked_and_what_is_accepted(served: ControlThread) -> None:
    with pytest.raises(ServiceError, match="restart web at service .*; found: no such request; accepted: attach"):
        restart(NAME, "web")


def test_a_service_that_does_not_run_is_named_with_those_that_do(served: ControlThread) -> None:
    with pytest.raises(
        ServiceError, match=f"attach at service pslv/none; found: it does not run.*; accepted: .*{NAME}"
    ):
        attach_to("pslv/none")


def test_only_services_that_answer_are_listed(served: ControlThread) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as mute:
        path = path_for(f"{NAME}-mute")
        mute.bind(str(path))
        mute.close()
        assert NAME in running_services()
        assert f"{NAME}-mute" in names()
        assert f"{NAME}-mute" not in running_services()
        abandoned = server.ControlSocket(f"{NAME}-mute", served.answer)  # takes the place of one that was killed
        abandoned.close()
        assert not path.exists()


def test_of_many_connections_in_a_second_some_wait(served: ControlThread) -> None:
    began = CLOCK.now()
    for _ in range(2 * server.MAX_PER_S + 1):
        attach_to(NAME).close()
    assert seconds_between(began, CLOCK.now()) > 1.9


def test_a_folder_that_somebody_else_has_made_is_not_entered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(control_files, "SHARED", (tmp_path,))
    taken = tmp_path / f"pslv-{os.geteuid()}"
    taken.mkdir()
    taken.chmod(0o777)
    path = path_for("pslv/8000")
    if path.parent.parent == tmp_path:  # else the user has a runtime folder, which no other can touch
        assert path.parent != taken
        assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(path))
            assert paths_of("pslv/8000") == [path]
            assert names() == ["pslv/8000"]


def test_a_name_is_taken_once(served: ControlThread) -> None:
    with pytest.raises(ServiceError, match=f"{NAME}; found: Address already in use"):
        server.ControlSocket(NAME, served.answer)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may be somebody else")
def test_another_user_is_not_answered(served: ControlThread) -> None:
    script = (
        "import os, socket, sys\n"
        "os.setuid(65534)\n"
        "peer = socket.socket(socket.AF_UNIX)\n"
        "try:\n    peer.connect(sys.argv[1])\n"
        "except PermissionError:\n    print('refused by the kernel')\n"
    )
    command = [sys.executable, "-c", script, str(path_for(NAME))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "refused by the kernel", "it costs the supervisor nothing"
    assert served.asked == []
