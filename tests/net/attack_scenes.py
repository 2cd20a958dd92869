"""Main module, in a network namespace of its own: a server, and a second computer that attacks it (security, U1 to U5).

Each scene prints its name when the attack failed, and on stderr what it was able to do.
"""

import contextlib
import json
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from tests.net.namespace_scenes import CLIENT, KEY, OTHER_CLIENT, SERVER, cable, hall, ip, newest, robot, sees, there
from tests.net.serving import Stadium, running
from vision_core.client import Connection
from vision_core.errors import ConnectionRefused
from vision_core.protocol.options import Options
from vision_core.protocol.proofs import key_digest
from vision_core.protocol.rate_limits import AMPLIFICATION

NOBODY = "10.0.0.77"
"""No computer has this address."""
QUIET_S = 0.2
UDP = 17
FORMS = (
    b"(", b"(init blue 3)", b"(init blue 3", b"(init blue 3 (version 2))", b"(init blue 99)", b"(dispinit)", b"(bye)",
    b"(lag 1.0 0 0)", b"(mirror)", b"(ping 7)", b"(sync 1 2)", b"(set (rate 10))", b"(what)", b"(init blue 1)" * 16,
    b"(reconnect blue 3 (key %s))" % (b"k" * 43),
)  # fmt: skip
FORGED = (b"(init blue 3)", b"(init blue 3 (version 2))", b"(init blue 3 (port same))", b"(bye)", b"(bye blue 3)")
STRANGERS = 120_000
MAX_GROWTH = 5 << 20
"""Of the server's memory [bytes]."""
BINDER = """
import socket, sys
host, taken = sys.argv[1], 0
for port in map(int, sys.argv[2:]):
    for address in (host, "0.0.0.0"):
        for options in ((), (socket.SO_REUSEADDR,), (socket.SO_REUSEPORT,), (socket.SO_REUSEADDR, socket.SO_REUSEPORT)):
            thief = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            for option in options:
                thief.setsockopt(socket.SOL_SOCKET, option, 1)
            try:
                thief.bind((address, port))
                taken += 1
            except OSError:
                pass
            thief.close()
print(taken)
"""


class Forger:
    """Sends datagrams in the name of any address."""

    def __init__(self, pid: int, port: int) -> None:
        self._port = port
        self._raw = there(pid, lambda: socket.socket(socket.AF_INET, socket.SOCK_RAW, socket.IPPROTO_RAW))

    def send(self, source: tuple[str, int], datagram: bytes) -> None:
        """The kernel fills in the length, the identification and the checksum of the header."""
        udp = struct.pack("!HHHH", source[1], self._port, 8 + len(datagram), 0) + datagram
        addresses = socket.inet_aton(source[0]) + socket.inet_aton(SERVER)
        header = struct.pack("!BBHHHBBH", 0x45, 0, 0, 0, 0, 64, UDP, 0) + addresses
        self._raw.sendto(header + udp, (SERVER, 0))

    def close(self) -> None:
        self._raw.close()


@contextlib.contextmanager
def attacked(*, admitted: bool = True) -> Iterator[tuple[Stadium, int, Forger]]:
    with cable() as pid, hall(admitted=admitted) as stadium, contextlib.closing(Forger(pid, stadium.port)) as forger:
        yield stadium, pid, forger


def speaker(pid: int, host: str) -> socket.socket:
    """A socket of the attacker's computer."""

    def opened() -> socket.socket:
        made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        made.bind((host, 0))
        made.settimeout(QUIET_S)
        return made

    return there(pid, opened)


def answers(client: socket.socket, port: int, datagram: bytes) -> list[bytes]:
    client.sendto(datagram, (SERVER, port))
    found = []
    with contextlib.suppress(TimeoutError):
        while True:
            found.append(client.recv(2048))
    return found


def told(**figures: object) -> None:
    print(json.dumps(figures), file=sys.stderr)


def u1_no_other_program_gets_the_ports() -> None:
    with attacked() as (stadium, pid, _), running(stadium):
        client = robot(stadium, pid)
        sees(client)
        ports = map(str, (stadium.port, stadium.session.getsockname()[1]))
        tried = subprocess.run(
            [sys.executable, "-c", BINDER, SERVER, *ports], capture_output=True, text=True, check=True
        )
        told(binds_that_succeeded_of_16=int(tried.stdout))
        assert int(tried.stdout) == 0
        client.close()


def u2_a_stranger_gets_one_short_reply_to_a_datagram_at_most() -> None:
    with attacked(admitted=False) as (stadium, pid, _), running(stadium):
        sent = received = replies = 0
        for number, form in enumerate(FORMS):
            host = f"10.0.0.{100 + number}"
            ip("addr", "add", f"{host}/24", "dev", "there", pid=pid)
            with speaker(pid, host) as stranger:
                for port in (stadium.port, stadium.session.getsockname()[1]):
                    got = answers(stranger, port, form)
                    assert len(got) <= 1, (form, got)
                    assert sum(map(len, got)) <= AMPLIFICATION * len(form), (form, got)
                    sent, received, replies = sent + len(form), received + sum(map(len, got)), replies + len(got)
        told(datagrams=2 * len(FORMS), replies=replies, bytes_sent=sent, bytes_received=received)
        assert len(stadium.server.sessions) == 0


def u2_strangers_leave_nothing_behind() -> None:
    with attacked(admitted=False) as (stadium, _, forger), running(stadium):
        ip("route", "add", "10.0.0.0/8", "dev", "here")
        before = resident()
        for number in range(STRANGERS):
            form = FORMS[number % len(FORMS)]
            forger.send((f"10.{number >> 14 & 255}.{number >> 6 & 255}.{2 + number % 64}", 1024 + number % 60000), form)
        time.sleep(QUIET_S)
        told(forged_datagrams=STRANGERS, growth_kib=(resident() - before) >> 10)
        assert resident() - before < MAX_GROWTH
        assert len(stadium.server.sessions) == 0


def resident() -> int:
    """Memory of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * 4096


def u3_a_robot_is_not_held_by_a_computer_that_does_not_exist() -> None:
    with attacked() as (stadium, pid, forger), running(stadium):
        forger.send((NOBODY, 4000), b"(init blue 3)")
        until(lambda: len(stadium.server.sessions) == 1)
        began = time.monotonic()
        client = claimed(stadium, pid)
        told(seconds_until_the_right_client_sees=round(time.monotonic() - began, 2))
        (session,) = stadium.server.sessions
        assert session.peer.host == CLIENT
        client.close()


def claimed(stadium: Stadium, pid: int) -> Connection:
    """The robot, asked for until it is given."""
    while True:
        try:
            client = robot(stadium, pid)
        except ConnectionRefused:
            time.sleep(QUIET_S)
            continue
        sees(client)
        return client


def u4_a_forged_init_replaces_no_owner() -> None:
    with attacked() as (stadium, pid, forger), running(stadium):
        client = robot(stadium, pid)
        before = sees(client)
        (owner,) = stadium.server.sessions
        forged = (
            b"(init blue 3)",
            b"(init blue 3 (version 2))",
            b"(bye)",
            b"(bye blue 3)",
            b"(init blue 3 (port same))",
        )
        for datagram in forged * 20:
            forger.send((CLIENT, 4001), datagram)
            time.sleep(0.02)
            newest(client)
        time.sleep(1.5)
        told(forged=20 * len(FORGED), sessions=len(stadium.server.sessions))
        assert tuple(stadium.server.sessions) == (owner,)
        assert newest(client) > before
        client.close()


def u5_admitted_computers_leave_each_other_their_share() -> None:
    with attacked() as (stadium, pid, forger), running(stadium):
        connected = 0
        for _ in range(10):
            for neighbor in range(8):
                for _ in range(20):
                    forger.send((f"10.0.0.{50 + neighbor}", 5000), b"(init yellow 9)" * 16)
            client = robot(stadium, pid)
            connected += 1
            client.close()
        told(connects_of_10=connected)


def cookies_are_of_one_address_and_one_moment() -> None:
    with attacked() as (stadium, pid, _), running(stadium):
        ip("addr", "add", f"{OTHER_CLIENT}/24", "dev", "there", pid=pid)
        init = b"(init blue 3 (version 2) (cookie %s))"
        with speaker(pid, CLIENT) as own, speaker(pid, CLIENT) as port, speaker(pid, OTHER_CLIENT) as host:
            (challenge,) = answers(own, stadium.port, b"(init blue 3 (version 2))")
            cookie = challenge[len("(challenge ") : -1]
            flipped = (b"1" if cookie[:1] == b"0" else b"0") + cookie[1:]
            for thief, wrong in ((port, cookie), (host, cookie), (own, flipped)):
                (refused,) = answers(thief, stadium.port, init % wrong)
                assert refused.startswith(b"(challenge "), refused
            assert len(stadium.server.sessions) == 0
            own.sendto(init % cookie, (SERVER, stadium.port))
            granted = own.recv(2048)
            assert granted.startswith(b"(init blue 3 play_on (version 2)"), granted
            own.sendto(b"(bye)", (SERVER, stadium.port))
        told(cookies_taken_of_3_wrong_ones=0)


def in_a_match_a_team_sees_its_own_views_alone() -> None:
    with attacked() as (stadium, pid, _):
        stadium.restart(replace(stadium.rules, fixed=Options(), monitor_key=key_digest("m" * 43)))
        with running(stadium), speaker(pid, CLIENT) as team:
            for form, word in (
                (b"(dispinit)", b"not_admitted"),
                (b"(dispinit (key %s))" % KEY.encode(), b"wrong_key"),
                (b"(init yellow 3 (version 2) (key %s))" % KEY.encode(), b"wrong_key"),
                (b"(init blue 3 (version 2) (key %s))" % KEY.encode(), b"(init blue 3"),
            ):
                (challenge,) = answers(team, stadium.port, form)
                again = form[:-1] + b" (cookie %s))" % challenge[len("(challenge ") : -1]
                team.sendto(again, (SERVER, stadium.port))
                answer = team.recv(2048)
                assert word in answer, (form, answer)
            team.sendto(b"(bye)", (SERVER, stadium.port))


def until(holds: Callable[[], bool]) -> None:
    while not holds():
        time.sleep(0.01)


SCENES: dict[str, Callable[[], None]] = {
    scene.__name__: scene
    for scene in (
        u1_no_other_program_gets_the_ports,
        u2_a_stranger_gets_one_short_reply_to_a_datagram_at_most,
        u2_strangers_leave_nothing_behind,
        u3_a_robot_is_not_held_by_a_computer_that_does_not_exist,
        u4_a_forged_init_replaces_no_owner,
        u5_admitted_computers_leave_each_other_their_share,
        cookies_are_of_one_address_and_one_moment,
        in_a_match_a_team_sees_its_own_views_alone,
    )
}

if __name__ == "__main__":
    assert socket.if_nameindex()
    SCENES[sys.argv[1]]()
    print(sys.argv[1])
