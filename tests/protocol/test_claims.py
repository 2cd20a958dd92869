"""Who gets a robot that another client has: nobody by a forged sender, a restarted program soon."""

import pytest

from tests.protocol.samples import CLIENT, OTHER, SESSION, TEAMMATE, Server, replies
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import RequestRefused, SessionClosed, SessionOpened
from vision_core.protocol.lifecycle import FORSAKEN_S, SessionTrigger
from vision_core.protocol.session import CLAIM_S
from vision_core.types.objects import Team

INIT = b"(init blue 3)"
GRANTED = b"(init blue 3 play_on)"


def owners(server: Server) -> list[object]:
    return [session.peer for session in server.sessions]


def decided(server: Server) -> list[bytes]:
    server.clock.advance(CLAIM_S + 0.1)
    return replies(server.sessions.expire(server.clock.now()))


def test_a_forged_init_of_the_owners_computer_takes_nothing() -> None:
    server = Server()
    server.hear(INIT)
    assert server.answers(INIT, OTHER) == [GRANTED]  # it goes to the owner: is it still there?
    assert owners(server) == [CLIENT]
    assert decided(server) == [b"(error already_connected)"]
    assert owners(server) == [CLIENT]


def test_the_operator_sees_the_refused_claim() -> None:
    server = Server()
    server.hear(INIT)
    server.hear(INIT, OTHER)
    server.clock.advance(CLAIM_S + 0.1)
    events = server.sessions.expire(server.clock.now())
    assert RequestRefused(OTHER, ErrorCode.ALREADY_CONNECTED, Team.BLUE, 3) in events


def test_a_restarted_client_gets_its_robot_as_soon_as_the_old_port_is_found_closed() -> None:
    server = Server()
    (opened, *_) = server.hear(INIT)
    assert isinstance(opened, SessionOpened)
    server.hear(INIT, OTHER)
    events = server.sessions.refused(opened.session, server.clock.now())
    assert events[0] == SessionClosed(opened.session, SessionTrigger.REFUSED)
    assert replies(events) == [GRANTED]
    assert owners(server) == [OTHER]


def test_a_claim_that_is_repeated_is_decided_in_the_same_time() -> None:
    server = Server()
    server.hear(INIT)
    for _ in range(3):
        server.hear(INIT, OTHER)
        server.clock.advance(CLAIM_S / 2)
    assert replies(server.sessions.expire(server.clock.now())) == [b"(error already_connected)"]


@pytest.mark.parametrize("answers", [True, False])
def test_an_owner_of_version_2_keeps_its_robot_if_it_answers(answers: bool) -> None:
    server = Server()
    server.open_2(INIT)
    assert server.answers(INIT, OTHER) == [b"(ping)"]
    if answers:
        server.clock.advance(0.1)
        server.hear(b"(ping)", CLIENT, SESSION)
    told = decided(server)
    assert told == ([b"(error already_connected)"] if answers else [b"(error replaced)", GRANTED])
    assert owners(server) == [CLIENT if answers else OTHER]


def test_a_client_of_version_2_on_the_same_computer_takes_over_with_its_cookie() -> None:
    server = Server()
    server.hear(INIT)
    told = replies(server.open_2(INIT, OTHER))
    assert told[0] == b"(error replaced)"
    assert owners(server) == [OTHER]


def test_another_computer_takes_over_by_no_cookie() -> None:
    server = Server()
    server.hear(INIT)
    assert replies(server.open_2(INIT, TEAMMATE)) == [b"(error already_connected)"]
    assert owners(server) == [CLIENT]


def find_nobody(server: Server) -> None:
    """The network reports that no computer has the client's address."""
    (session,) = server.sessions
    session.unreachable = server.clock.now()


def test_a_robot_is_not_held_by_a_computer_that_does_not_exist() -> None:
    server = Server()
    server.hear(INIT, TEAMMATE)
    assert server.answers(INIT) == [b"(error already_connected)"]
    find_nobody(server)
    server.clock.advance(4.0)  # until the kernel has asked again
    assert server.answers(INIT) == [b"(error replaced)", GRANTED]
    assert owners(server) == [CLIENT]


def test_a_client_that_was_heard_keeps_its_robot_while_its_network_is_down() -> None:
    server = Server()
    server.hear(INIT, TEAMMATE)
    server.hear(b"(mirror)", TEAMMATE, SESSION)
    find_nobody(server)
    assert server.answers(INIT) == [b"(error already_connected)"]


def test_a_gap_of_the_network_is_forgotten() -> None:
    server = Server()
    server.hear(INIT, TEAMMATE)
    find_nobody(server)
    server.clock.advance(FORSAKEN_S + 1.0)
    assert server.answers(INIT) == [b"(error already_connected)"]
