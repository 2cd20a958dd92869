"""The server on real sockets: ten clients, lost and moved ones, and a restart."""

import contextlib
import socket
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from ipaddress import ip_network

import pytest

from tests.net.serving import PATIENCE_S, Stadium, robot
from vision_core.clock import Instant
from vision_core.net.delivery import Batch
from vision_core.net.delivery_rows import UNKNOWN, mean_rank
from vision_core.net.server import MAX_DATAGRAMS
from vision_core.net.udp import SendResult, SessionSocket
from vision_core.protocol import admission
from vision_core.protocol.admission import Admission
from vision_core.protocol.answers import decode_message
from vision_core.protocol.events import LagReported, Reply, SessionClosed, SessionMoved, SessionOpened
from vision_core.protocol.lifecycle import SessionState, SessionTrigger
from vision_core.protocol.messages import SyncReply
from vision_core.protocol.session import Sessions

EDGES = b"w2c" * 360
IP_RECVTTL = 12
"""Of Linux (ip(7)); the socket module has no name for it."""


@pytest.fixture
def stadium() -> Iterator[Stadium]:
    opened = Stadium()
    yield opened
    opened.close()


def test_ten_clients_get_their_frames(stadium: Stadium) -> None:
    with contextlib.ExitStack() as stack:
        clients = {
            (team, number): stack.enter_context(robot(stadium, f"(init {team} {number})".encode()))
            for team in ("blue", "yellow")
            for number in range(1, 6)
        }
        events = stadium.serve()
        assert sum(isinstance(event, SessionOpened) for event in events) == 10
        reports = [stadium.send_frame() for _ in range(3)]
        for (team, number), client in clients.items():
            reply, source = client.recvfrom(2000)
            assert reply == f"(init {team} {number} play_on)".encode()
            assert source == stadium.session.getsockname()
            for _ in reports:
                see, source = client.recvfrom(2000)
                assert source == stadium.session.getsockname()
                assert EDGES in see
                assert see.endswith(b"((ball) 61 121 6))")
        for report in reports:
            assert [delivery.rank for delivery in report.deliveries] == list(range(10))
            sent = [delivery.sent_at for delivery in report.deliveries]
            assert sent == sorted(sent)
            assert {delivery.result for delivery in report.deliveries} == {SendResult.SENT}
        rows = [stadium.server.delivery(session) for session in stadium.server.sessions]
        assert [(int(row["sent"]), int(row["dropped"]), int(row["frames"])) for row in rows] == [(3, 0, 3)] * 10


def test_the_order_is_random_and_fair(stadium: Stadium) -> None:
    with contextlib.ExitStack() as stack:
        for number in range(1, 5):
            stack.enter_context(robot(stadium, f"(init blue {number})".encode()))
        stadium.serve()
        begin = stadium.clock.now()
        reports = [stadium.send_frame(Instant(begin + i * 1_000_000)) for i in range(400)]
        orders = {tuple(delivery.session.number for delivery in report.deliveries) for report in reports}
        assert len(orders) == 24
        for session in stadium.server.sessions:
            assert 0.4 < mean_rank(stadium.server.delivery(session)) < 0.6


def test_a_robot_that_the_camera_does_not_see_hears_nothing(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        client.recv(2000)
        stadium.blind = True
        assert stadium.send_frame().deliveries == ()
        stadium.blind = False
        stadium.send_frame()
        assert client.recv(2000).startswith(b"(see ")


def test_a_report_on_the_view_just_sent_tells_the_networks_lag(stadium: Stadium) -> None:
    """It holds also when sessions come in between; the one on an older view tells nothing."""
    with robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        server = client.recvfrom(2000)[1]
        stadium.send_frame()
        older = client.recv(2000).split()[1]
        (delivery,) = stadium.send_frame().deliveries
        newest = client.recv(2000).split()[1]
        session = delivery.session
        client.sendto(b"(lag %s 0 1)" % older, server)
        stadium.serve()
        assert stadium.server.delivery(session)["network_ns"] == UNKNOWN
        with robot(stadium, b"(init blue 4)"):
            stadium.serve()
            assert len(stadium.server.due(stadium.clock.now())[0]) == 2
            client.sendto(b"(lag %s 0 1.5)" % newest, server)
            (event,) = stadium.serve()
            assert isinstance(event, LagReported)
        row = stadium.server.delivery(session)
        assert row["sent_at"] == delivery.sent_at
        assert 0 < 2 * row["network_ns"] <= row["reported_at"] - delivery.sent_at
        assert row["client_ns"] == 1_500_000


def test_no_frame_is_sent_twice(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)"):
        stadium.serve()
        at = stadium.clock.now()
        assert len(stadium.send_frame(at).deliveries) == 1
        assert stadium.send_frame(at).deliveries == ()


def test_a_crashed_client_is_gone_within_a_frame_and_its_neighbors_notice_nothing(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as crashed, robot(stadium, b"(init blue 4)") as neighbor:
        stadium.serve()
        crashed_session, _ = stadium.server.sessions
        crashed_session.inited = Instant(0)  # long ago
        stadium.send_frame()
        crashed.close()
        time.sleep(0.002)
        stadium.send_frame()  # meets a closed port
        events = stadium.serve()
        assert SessionClosed(crashed_session, SessionTrigger.REFUSED) in events
        assert [session.number for session in stadium.server.sessions] == [4]
        neighbor.recv(2000)
        for _ in range(2):
            assert neighbor.recv(2000).startswith(b"(see ")


def test_a_client_that_leaves_before_its_first_answer(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)"):
        pass
    stadium.serve()
    for _ in range(5):
        time.sleep(0.002)
        stadium.send_frame()
        stadium.serve(0.01)
    assert len(stadium.server.sessions) == 0


def test_a_client_connected_to_the_main_port_is_answered_from_there(stadium: Stadium) -> None:
    """Its kernel refuses the session port, so the session moves without a word from it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.settimeout(2.0)
        client.connect(("127.0.0.1", stadium.port))
        client.send(b"(init blue 3)")
        events = stadium.serve()
        while not any(isinstance(event, SessionMoved) for event in events):
            events = stadium.serve()
        assert client.recv(2000) == b"(init blue 3 play_on)"
        stadium.send_frame()
        assert client.recv(2000).startswith(b"(see ")
        client.send(b"(bye)")
        (closed,) = stadium.serve()
        assert isinstance(closed, SessionClosed)
        assert closed.reason is SessionTrigger.LEFT


@pytest.mark.parametrize("inits", [[b"(init blue 3 (port same))"], [b"(init blue 3)"] * 3])
def test_views_from_the_main_port_when_asked_or_unheard(stadium: Stadium, inits: list[bytes]) -> None:
    with robot(stadium, inits[0]) as client:
        stadium.serve()
        for init in inits[1:]:
            client.sendto(init, stadium.main.getsockname())
            stadium.serve()
        sources = [client.recvfrom(2000)[1] for _ in inits]
        assert sources[-1] == stadium.main.getsockname()
        stadium.send_frame()
        see, source = client.recvfrom(2000)
        assert see.startswith(b"(see ")
        assert source == stadium.main.getsockname()


def test_a_guest_of_the_open_practice_is_reached_in_the_local_network_only(
    stadium: Stadium, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(admission, "LOCAL", (ip_network("127.0.0.0/8"),))
    stadium.restart(replace(stadium.rules, admission=Admission(loopback=False, open_practice=True)))
    with robot(stadium, b"(init blue 3)") as client:
        client.setsockopt(socket.IPPROTO_IP, IP_RECVTTL, 1)
        stadium.serve()
        stadium.send_frame()
        assert [_hops(client) for _ in range(2)] == [1, 1]  # the answer and a view
        stadium.server.apply(replace(stadium.rules, admission=Admission()), "play_on", stadium.clock.now())
        stadium.send_frame()
        assert _hops(client) > 1


def _hops(client: socket.socket) -> int:
    """Hops that a datagram had left when it arrived."""
    _, ancillary, _, _ = client.recvmsg(2000, socket.CMSG_SPACE(4))
    return int.from_bytes(ancillary[0][2], sys.byteorder)


def test_bye_and_the_robot_is_free(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        client.sendto(b"(bye)", client.recvfrom(2000)[1])
        (closed,) = stadium.serve()
        assert isinstance(closed, SessionClosed)
        assert stadium.send_frame().deliveries == ()


def test_a_stranger_at_the_session_port_disturbs_nobody(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as client, robot(stadium, b"") as stranger:
        stadium.serve()
        for noise in (b"(bye)", b"(dash 100)", b"\xff" * 1400, b""):
            stranger.sendto(noise, stadium.session.getsockname())
        while not any(isinstance(event, Reply) and b"not_connected" in event.data for event in stadium.serve()):
            pass
        assert stranger.recvfrom(2000) == (b"(error not_connected)", stadium.session.getsockname())
        client.recv(2000)
        stadium.send_frame()
        assert client.recv(2000).startswith(b"(see ")


def test_a_restarted_client_takes_over(stadium: Stadium) -> None:
    """The old program has ended: its computer says so when it is asked."""
    with robot(stadium, b"(init blue 3)") as old:
        stadium.serve()
        assert old.recv(2000) == b"(init blue 3 play_on)"
    with robot(stadium, b"(init blue 3)") as new:
        stadium.serve()
        stadium.serve()  # the report that the old port is closed
        assert new.recv(2000) == b"(init blue 3 play_on)"
        assert len(stadium.send_frame().deliveries) == 1


def test_a_program_that_still_runs_keeps_its_robot(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as old, robot(stadium, b"(init blue 3)") as new:
        stadium.serve()
        assert [old.recv(2000) for _ in range(2)] == [b"(init blue 3 play_on)"] * 2
        (session,) = stadium.server.sessions
        assert session.claim is not None
        session.claim = replace(session.claim, at=Instant(session.claim.at - 2 * 10**9))
        stadium.server.expire()
        assert new.recv(2000) == b"(error already_connected)"
        stadium.send_frame()
        assert old.recv(2000).startswith(b"(see ")


def test_the_clock_is_stamped_when_it_is_sent(stadium: Stadium) -> None:
    before = stadium.clock.now() - stadium.rules.boot
    with robot(stadium, b"(init blue 3)(sync 7 -5)") as client:
        stadium.serve()
        client.recv(2000)
        answer = decode_message(client.recv(2000))
        after = stadium.clock.now() - stadium.rules.boot
        assert isinstance(answer, SyncReply)
        assert (answer.id, answer.t1_ns) == (7, -5)
        assert before <= answer.t2_ns <= answer.t3_ns <= after


def test_one_socket_with_two_robots(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)(init blue 4)") as client:
        stadium.serve()
        client.recv(2000)
        client.recv(2000)
        assert len(stadium.send_frame().deliveries) == 2
        assert all(client.recv(2000).startswith(b"(see ") for _ in range(2))


def test_a_flood_is_handled_in_portions(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as client:
        for _ in range(3 * MAX_DATAGRAMS):
            client.sendto(b"(dash 100)", stadium.main.getsockname())
        stadium.serve()
        assert 0 < stadium.server.sessions.counts.received <= MAX_DATAGRAMS


def test_strangers_have_a_budget_of_time_between_two_frames() -> None:
    """One datagram uses up this one. A client's own datagrams are read all the same."""
    with contextlib.closing(Stadium(strangers_s=1e-9)) as stadium, robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        client.recv(2000)
        stadium.send_frame()
        client.recv(2000)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            stranger.settimeout(PATIENCE_S)
            for number in range(1, 4):
                stranger.sendto(b"(ping %d)" % number, stadium.main.getsockname())
                client.sendto(b"(ping %d)" % number, stadium.session.getsockname())
            stadium.serve()
            assert [client.recv(2000) for _ in range(3)] == [b"(pong 1)", b"(pong 2)", b"(pong 3)"]
            assert stranger.recv(2000) == b"(pong 1)"
            stadium.serve()  # the shared sockets wake nobody
            stranger.settimeout(0.0)
            with pytest.raises(BlockingIOError):
                stranger.recv(2000)
            stranger.settimeout(PATIENCE_S)
            stadium.send_frame()
            stadium.serve()
            assert stranger.recv(2000) == b"(pong 2)"
            stadium.server.expire()  # no frame comes
            stadium.serve()
            assert stranger.recv(2000) == b"(pong 3)"


def test_no_socket_left(stadium: Stadium, monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(self: SessionSocket, *arguments: object) -> None:
        raise OSError(24, "Too many open files")

    monkeypatch.setattr(SessionSocket, "__init__", exhausted)
    with robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        assert client.recvfrom(2000) == (b"(error server_full)", stadium.main.getsockname())
        assert len(stadium.server.sessions) == 0


def test_the_end_of_the_lease_closes_the_socket_too(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)"):
        stadium.serve()
        (third,) = stadium.server.sessions
        third.heard = Instant(stadium.clock.now() - 601 * 10**9)
        assert stadium.server.expire() == [SessionClosed(third, SessionTrigger.SILENT)]
        assert third not in stadium.server
        with pytest.raises(KeyError):
            stadium.server.delivery(third)


def test_a_client_may_change_its_options_and_its_counters_go_on(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        stadium.send_frame()
        client.sendto(b"(init blue 3 (fov 90)(rate 1))", stadium.main.getsockname())
        stadium.serve()
        begin = stadium.clock.now() + 10_000_000
        served = [len(stadium.send_frame(Instant(begin + i * 100_000_000)).deliveries) for i in range(20)]
        assert [index for index, count in enumerate(served) if count] == [0, 5, 15]  # on the grid of a second, or near
        sees = [data for data in (client.recv(2000) for _ in range(6)) if data.startswith(b"(see ")]
        assert [data.count(b"w2c") for data in sees] == [360, 90, 90, 90]
        (third,) = stadium.server.sessions
        assert stadium.server.delivery(third)["sent"] == 4


def test_sessions_keep_their_tuple_until_something_changes(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        sessions, _ = stadium.server.due(stadium.clock.now())
        client.sendto(b"(init blue 3)(dash 3)", stadium.main.getsockname())
        stadium.serve()
        assert stadium.server.due(stadium.clock.now())[0] is sessions
        client.sendto(b"(init blue 3 (types team))", stadium.main.getsockname())
        stadium.serve()
        with pytest.raises(ValueError, match="1 datagrams for the sessions of due.*changed"):
            stadium.server.send_batch(stadium.clock.now(), Batch.of([b""]))
        assert stadium.server.due(stadium.clock.now())[0] is not sessions
        with pytest.raises(ValueError, match="2 datagrams for the sessions of due"):
            stadium.server.send_batch(stadium.clock.now(), Batch.of([b"", b""]))


def test_a_restarted_process_goes_on_with_the_same_clients(stadium: Stadium) -> None:
    """Same ports, options and order of Time; clients notice nothing."""
    with robot(stadium, b"(init blue 3)\0") as third, robot(stadium, b"(init blue 4 (port same)(fov 90))") as fourth:
        stadium.serve()
        at = stadium.clock.now()
        stadium.send_frame(at)
        snapshot = stadium.server.snapshot()
        stadium.server.close()  # the process ends; its supervisor keeps the two sockets

        stadium.restore(snapshot)
        assert stadium.server.snapshot() == snapshot
        assert [row["sent"] for row in map(stadium.server.delivery, stadium.server.sessions)] == [1, 1]
        assert stadium.send_frame(at).deliveries == ()
        stadium.send_frame()
        for client, source, end in ((third, stadium.session, b"\0"), (fourth, stadium.main, b")")):
            client.recv(2000)
            before = client.recv(2000)
            after, sender = client.recvfrom(2000)
            assert sender == source.getsockname()
            assert float(after.split()[1]) > float(before.split()[1])
            assert len(after) == len(before)
            assert after.endswith(end)
        third.sendto(b"(init blue 3)\0", stadium.session.getsockname())
        stadium.serve()
        assert third.recvfrom(2000) == (b"(init blue 3 play_on)\0", stadium.session.getsockname())
        assert [session.state for session in stadium.server.sessions] == [SessionState.SETTLED, SessionState.SAME_PORT]


@pytest.mark.parametrize("damage", [lambda data: data[:-1], lambda data: data.partition(b"\n")[0], lambda data: b""])
def test_a_damaged_snapshot_is_refused(stadium: Stadium, damage: Callable[[bytes], bytes]) -> None:
    with robot(stadium, b"(init blue 3)"):
        stadium.serve()
        snapshot = stadium.server.snapshot()
        stadium.server.close()
        with pytest.raises(ValueError):  # noqa: PT011 (JSON's own message, or ours)
            stadium.restore(damage(snapshot))


def test_a_session_that_is_opened_or_moved_between_frames_is_in_the_snapshot(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as client, robot(stadium, b"(init yellow 1)"):
        stadium.serve()
        stadium.send_frame()
        client.sendto(b"(init blue 3 (port same))", stadium.main.getsockname())
        stadium.serve()
        snapshot = stadium.server.snapshot()
        stadium.server.close()
        stadium.restore(snapshot)
        sent = {session.team: stadium.server.delivery(session)["sent"] for session in stadium.server.sessions}
        assert sent == {"blue": 1, "yellow": 1}


def test_closing_lets_go_of_everything_but_the_two_sockets(stadium: Stadium) -> None:
    with robot(stadium, b"(init blue 3)") as client:
        stadium.serve()
        stadium.server.close()
        client.recv(2000)
        client.sendto(b"(see later", stadium.session.getsockname())
        stadium.start(Sessions(stadium.rules))
        assert stadium.serve() == []
        assert stadium.server.sessions.counts.received == 1
