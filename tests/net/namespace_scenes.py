"""Main module, in a network namespace of its own: a server and, in a second namespace, clients, joined by a cable.

Each scene prints its name when everything was as it says. The server is 10.0.0.1, the client 10.0.0.2.
"""

import contextlib
import ctypes
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from tests.net.serving import Stadium, running
from vision_core.client import Connection, connect
from vision_core.net.udp import SendResult
from vision_core.protocol.admission import Admission
from vision_core.protocol.proofs import key_digest
from vision_core.types.objects import Team

CLONE_NEWNET = 0x40000000
SERVER, CLIENT, OTHER_SERVER, OTHER_CLIENT = "10.0.0.1", "10.0.0.2", "10.0.0.3", "10.0.0.4"
KEY = "k" * 43
PATIENCE_S = 20.0
Made = TypeVar("Made")


def ip(*words: str, pid: int | None = None) -> None:
    inside = ["nsenter", "-t", str(pid), "-n"] if pid else []
    subprocess.run([*inside, "ip", *words], check=True)


@contextlib.contextmanager
def cable() -> Iterator[int]:
    """Joins this namespace to a second one; gives the id of the process that keeps that one."""
    with subprocess.Popen(["unshare", "-n", "sleep", "600"]) as keeper:
        own = Path("/proc/self/ns/net").stat().st_ino
        while Path(f"/proc/{keeper.pid}/ns/net").stat().st_ino == own:
            time.sleep(0.01)
        ip("link", "set", "lo", "up")
        ip("link", "add", "here", "type", "veth", "peer", "name", "there", "netns", str(keeper.pid))
        ip("addr", "add", f"{SERVER}/24", "dev", "here")
        ip("link", "set", "here", "up")
        ip("addr", "add", f"{CLIENT}/24", "dev", "there", pid=keeper.pid)
        ip("link", "set", "there", "up", pid=keeper.pid)
        try:
            yield keeper.pid
        finally:
            keeper.kill()


def there(pid: int, what: Callable[[], Made]) -> Made:
    """Do something in the other namespace: a socket stays where it was made."""

    def run() -> Made:
        with Path(f"/proc/{pid}/ns/net").open() as other:
            if ctypes.CDLL(None, use_errno=True).setns(other.fileno(), CLONE_NEWNET):
                raise OSError(ctypes.get_errno(), "setns")
        return what()

    with ThreadPoolExecutor(1) as thread:
        return thread.submit(run).result()


@contextlib.contextmanager
def hall(*, admitted: bool = True) -> Iterator[Stadium]:
    """A server at every address of this namespace."""
    stadium = Stadium(host="0.0.0.0")
    networks = ["10.0.0.0/24"] if admitted else []
    keys = {Team.BLUE: key_digest(KEY)}
    stadium.restart(replace(stadium.rules, admission=Admission.from_subnets(networks), keys=keys))
    stadium.send_frame()  # compiles
    yield stadium
    stadium.close()


def robot(stadium: Stadium, pid: int, key: str = "", host: str = SERVER) -> Connection:
    return there(pid, lambda: connect(host, stadium.port, "blue", 3, key=key, timeout_s=PATIENCE_S))


def sees(client: Connection) -> float:
    """Time of the next view."""
    view = client.receive(PATIENCE_S)
    assert view is not None
    return view.time_s


def newest(client: Connection) -> float:
    """Time of a view that was sent from now on."""
    while client.latest() is not None:
        pass
    return sees(client)


def interface_goes_down_and_up() -> None:
    with cable() as pid, hall() as stadium:
        with running(stadium):
            client = robot(stadium, pid)
            before = sees(client)
        (session,) = stadium.server.sessions
        ip("link", "set", "here", "down")
        for _ in range(20):
            frame = stadium.send_frame()
            stadium.server.handle_readable()
        assert [delivery.result for delivery in frame.deliveries] == [SendResult.DROPPED]
        assert tuple(stadium.server.sessions) == (session,)
        ip("link", "set", "here", "up")
        with running(stadium):
            assert newest(client) > before
            client.close()


def server_gets_another_address() -> None:
    with cable() as pid, hall() as stadium, running(stadium):
        client = robot(stadium, pid)
        sees(client)
        ip("addr", "del", f"{SERVER}/24", "dev", "here")
        ip("addr", "add", f"{OTHER_SERVER}/24", "dev", "here")
        again = robot(stadium, pid, host=OTHER_SERVER)
        assert sees(again) > 0.0
        again.close()
        client.close()


def a_client_follows_the_server_to_its_other_address() -> None:
    with cable() as pid, hall() as stadium, running(stadium):
        client = there(pid, lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        with client:
            client.settimeout(PATIENCE_S)
            client.sendto(b"(init blue 3)", (SERVER, stadium.port))
            assert client.recvfrom(2048)[1][0] == SERVER
            ip("addr", "add", f"{OTHER_SERVER}/24", "dev", "here")
            client.sendto(b"(init blue 3)", (OTHER_SERVER, stadium.port))
            while client.recvfrom(2048)[1][0] != OTHER_SERVER:
                pass
            client.sendto(b"(bye)", (OTHER_SERVER, stadium.port))


def server_gets_its_address_again() -> None:
    with cable() as pid, hall() as stadium, running(stadium):
        client = robot(stadium, pid)
        before = sees(client)
        ip("addr", "del", f"{SERVER}/24", "dev", "here")
        time.sleep(0.3)
        ip("addr", "add", f"{SERVER}/24", "dev", "here")
        assert newest(client) > before
        client.close()


def client_with_the_key_gets_another_address() -> None:
    with cable() as pid, hall(admitted=False) as stadium, running(stadium):
        client = robot(stadium, pid, key=KEY)
        before = sees(client)
        ip("addr", "add", f"{OTHER_CLIENT}/24", "dev", "there", pid=pid)
        ip("addr", "del", f"{CLIENT}/24", "dev", "there", pid=pid)
        ip("addr", "replace", f"{OTHER_CLIENT}/24", "dev", "there", pid=pid)
        assert newest(client) > before
        (session,) = stadium.server.sessions
        assert session.peer.host == OTHER_CLIENT
        client.close()


def a_paper_only_client_is_admitted_from_another_computer() -> None:
    with cable() as pid, hall(admitted=False) as stadium, running(stadium):
        paper = [sys.executable, "-m", "bench.paper_client", "blue", "3", "2", SERVER, str(stadium.port)]
        command = ["nsenter", "-t", str(pid), "-n", *paper]
        refused = subprocess.run(command, capture_output=True, text=True, check=False)
        assert "not_admitted" in refused.stdout + refused.stderr, refused
        rules = replace(stadium.rules, admission=Admission.from_texts((), [(CLIENT, Team.BLUE, 3)], ()))
        stadium.server.apply(rules, "play_on", stadium.clock.now())
        served = subprocess.run(command, capture_output=True, text=True, check=True)
        assert '"wrong": []' in served.stdout, served


SCENES: dict[str, Callable[[], None]] = {
    scene.__name__: scene
    for scene in (
        interface_goes_down_and_up,
        server_gets_another_address,
        a_client_follows_the_server_to_its_other_address,
        server_gets_its_address_again,
        client_with_the_key_gets_another_address,
        a_paper_only_client_is_admitted_from_another_computer,
    )
}

if __name__ == "__main__":
    assert socket.if_nameindex()
    SCENES[sys.argv[1]]()
    print(sys.argv[1])
