"""The server's side: every rule of the protocol, in bytes and instants."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.protocol.samples import (
    BOOT,
    CLIENT,
    MAIN,
    OTHER,
    SESSION,
    STRANGER,
    TEAMMATE,
    Network,
    Server,
    replies,
    rules,
)
from vision_core.clock import Instant, after
from vision_core.protocol.error_codes import ErrorName
from vision_core.protocol.lifecycle import Change, Peer, Port, Session
from vision_core.protocol.session import Arrival, Refused, Reply, SessionClosed, SessionMoved, SessionOpened, Sessions

INIT = b"(init blue 3)"
GRANTED = b"(init blue 3 play_on)"


def opened(server: Server, datagram: bytes = INIT, peer: Peer = CLIENT) -> Session:
    events = server.hear(datagram, peer)
    assert isinstance(events[0], SessionOpened)
    return events[0].session


def test_an_init_opens_a_session_and_is_answered_from_the_session_port() -> None:
    server = Server()
    events = server.hear(INIT)
    session = opened(Server())
    assert [type(event) for event in events] == [SessionOpened, Reply]
    reply = events[1]
    assert isinstance(reply, Reply)
    assert (reply.data, reply.to, reply.via) == (GRANTED, CLIENT, SESSION)
    assert reply.session is next(iter(server.sessions))
    assert session.port is Port.SESSION


def test_answers_end_like_the_request() -> None:
    assert Server().answers(INIT + b"\0") == [GRANTED + b"\0"]
    assert Server().answers(b"(init green 3)\0") == [b"(error illegal_team)\0"]


def test_the_mode_is_told() -> None:
    server = Server()
    server.sessions.mode = "before_kick_off"
    assert server.answers(INIT) == [b"(init blue 3 before_kick_off)"]


def test_a_repeated_init_is_answered_again_by_the_same_session() -> None:
    server = Server()
    session = opened(server)
    events = server.hear(INIT)
    assert [(event.data, event.session, event.via) for event in events if isinstance(event, Reply)] == [
        (GRANTED, session, SESSION)
    ]
    assert list(server.sessions) == [session]


def test_a_repeated_init_may_change_the_options() -> None:
    server = Server()
    session = opened(server)
    server.hear(b"(init blue 3 (types team))\0")
    assert session.init.options.types == "team"
    assert session.nul


def test_the_third_unanswered_init_moves_to_the_main_port() -> None:
    server = Server()
    session = opened(server)
    assert not any(isinstance(event, SessionMoved) for event in server.hear(INIT))
    events = server.hear(INIT)
    assert [type(event) for event in events] == [SessionMoved, Reply]
    assert isinstance(events[1], Reply)
    assert events[1].via == MAIN
    assert session.port is Port.MAIN


def test_inits_far_apart_or_answered_move_nothing() -> None:
    server = Server()
    session = opened(server)
    for _ in range(5):
        server.clock.advance(20.0)
        server.hear(INIT)
    assert session.port is Port.SESSION
    for _ in range(5):
        server.hear(INIT, arrival=SESSION)
    assert session.port is Port.SESSION


def test_port_same_stays_on_the_main_port() -> None:
    server = Server()
    session = opened(server, b"(init blue 3 (port same))")
    assert session.port is Port.MAIN


def test_a_refusal_right_after_the_init_moves_to_the_main_port_and_a_second_one_ends() -> None:
    server = Server()
    session = opened(server)
    moved = server.sessions.refused(session, server.clock.now())
    assert [type(event) for event in moved] == [SessionMoved, Reply]
    assert server.sessions.refused(session, server.clock.now()) == [SessionClosed(session, Change.REFUSED_AT_ONCE)]
    assert len(server.sessions) == 0


def test_a_later_refusal_ends_at_once_and_frees_the_robot() -> None:
    server = Server()
    session = opened(server)
    server.clock.advance(30.0)
    assert server.sessions.refused(session, server.clock.now()) == [SessionClosed(session, Change.REFUSED)]
    assert server.sessions.refused(session, server.clock.now()) == []
    opened(server, peer=TEAMMATE)


def test_a_client_that_was_heard_on_the_session_port_is_not_moved() -> None:
    server = Server()
    session = opened(server)
    server.hear(INIT, arrival=SESSION)
    assert server.sessions.refused(session, server.clock.now()) == [SessionClosed(session, Change.REFUSED_AT_ONCE)]


@pytest.mark.parametrize("arrival", [MAIN, SESSION])
def test_bye(arrival: Arrival) -> None:
    server = Server()
    session = opened(server)
    assert server.hear(b"(bye)", arrival=arrival) == [SessionClosed(session, Change.LEFT)]
    assert server.answers(b"(bye)") == [b"(error not_connected)"]


def test_one_socket_may_hold_several_robots_and_must_name_them() -> None:
    server = Server()
    third, fourth = opened(server), opened(server, b"(init blue 4)")
    assert server.answers(b"(bye)") == [b"(error illegal_form)"]
    assert server.hear(b"(bye blue 4)") == [SessionClosed(fourth, Change.LEFT)]
    assert server.hear(b"(bye)") == [SessionClosed(third, Change.LEFT)]


def served(session: Session, server: Server) -> Session:
    """It was just sent the view of Time 0.000."""
    session.note_served(BOOT)
    session.served_at = server.clock.now()
    return session


@pytest.mark.parametrize("arrival", [MAIN, SESSION])
def test_a_report_is_noted_and_not_answered(arrival: Arrival) -> None:
    server = Server()
    session = served(opened(server), server)
    server.clock.advance(0.010)
    assert server.hear(b"(lag 0.000 2 5.5)", arrival=arrival) == []
    assert session.network_s == pytest.approx(0.004)
    assert session.client_s == 0.0055
    assert session.reported == session.heard == server.clock.now()


def test_a_report_needs_a_session() -> None:
    server = Server()
    session = served(opened(server), server)
    assert server.answers(b"(lag 0.000 2 5.5)", OTHER) == [b"(error not_connected)"]
    assert server.answers(b"(lag blue 4 0.000 2 5.5)") == [b"(error not_connected)"]
    assert session.network_s is None


def test_one_socket_with_several_robots_reports_by_name() -> None:
    server = Server()
    third, fourth = served(opened(server), server), served(opened(server, b"(init blue 4)"), server)
    assert server.answers(b"(lag 0.000 0 5)") == [b"(error illegal_form)"]
    assert server.hear(b"(lag blue 4 0.000 0 5)") == []
    assert (third.client_s, fourth.client_s) == (None, 0.005)


def test_a_newer_client_of_the_same_computer_takes_over() -> None:
    server = Server()
    old = opened(server)
    events = server.hear(INIT, OTHER)
    assert [type(event) for event in events] == [Reply, SessionClosed, SessionOpened, Reply]
    told, closed = events[0], events[1]
    assert isinstance(told, Reply)
    assert (told.data, told.to, told.session) == (b"(error replaced)", CLIENT, old)
    assert closed == SessionClosed(old, Change.REPLACED)
    assert [session.peer for session in server.sessions] == [OTHER]


def test_another_computer_does_not() -> None:
    server = Server()
    opened(server)
    assert server.answers(INIT, TEAMMATE) == [b"(error already_connected)"]
    assert [session.peer for session in server.sessions] == [CLIENT]


@pytest.mark.parametrize(
    ("datagram", "error"),
    [
        (b"(init green 3)", b"illegal_team"),
        (b"(init blue 0)", b"illegal_number"),
        (b"(init blue 6)", b"illegal_number"),
        (b"(init blue -1)", b"illegal_number"),
        (b"(init blue 03)", b"illegal_number"),
        (b"(init blue 3 (types all))", b"illegal_option"),
        (b"(init blue 3 (mirror 0 0 0))", b"illegal_mirror"),
        (b"(init blue 3 (mirror 1.0 0.04 100))", b"illegal_mirror"),  # sees nothing beyond 1 m
        (b"(init blue 3", b"illegal_form"),
        (b"(dash 100)", b"unknown_command"),
        (b"(bye)", b"not_connected"),
    ],
)
def test_what_is_wrong_is_told_and_opens_nothing(datagram: bytes, error: bytes) -> None:
    server = Server()
    assert server.answers(datagram) == [b"(error %s)" % error]
    assert len(server.sessions) == 0


def test_a_session_without_a_socket_is_told_and_forgotten() -> None:
    server = Server()
    session = opened(server)
    events = server.sessions.not_opened(session)
    assert replies(events) == [b"(error server_full)"]
    assert len(server.sessions) == 0


def test_noise_is_complained_about_once_in_five_seconds() -> None:
    server = Server()
    assert server.answers(b"(dash 100)") == [b"(error unknown_command)"]
    assert server.answers(b"(kick 100)") == []
    server.clock.advance(5.0)
    assert server.answers(b"(dash 100)") == [b"(error unknown_command)"]


def test_a_datagram_with_several_mistakes_is_answered_once() -> None:
    assert Server().answers(b"(dash)(init green 1)(init blue 9)") == [b"(error unknown_command)"]


def test_too_many_inits_over_all_are_limited() -> None:
    server = Server()
    answers = []
    for computer in range(60):
        answers += server.answers(INIT, Peer(f"10.0.0.{computer}", 5000))
    assert answers.count(b"(error already_connected)") == 49
    assert answers.count(b"(error rate_limited)") == 10


def test_a_higher_version_is_answered_with_ours_and_a_warning() -> None:
    assert Server().answers(b"(init blue 3 (version 2))") == [GRANTED]
    assert Server().answers(b"(init blue 3 (version 2) (extra seq))") == [GRANTED, b"(warning unknown_option)"]


def test_strangers_get_one_short_error_now_and_then() -> None:
    server = Server()
    assert server.answers(INIT, STRANGER) == [b"(error not_admitted)"]
    assert server.hear(INIT, STRANGER) == []
    server.clock.advance(5.0)
    assert server.hear(INIT, STRANGER)[-1] == Refused(STRANGER, ErrorName.NOT_ADMITTED)
    assert len(server.sessions) == 0


@given(st.binary(max_size=1024) | st.text("(init bluebye)3\0 ", max_size=60).map(str.encode))
@settings(max_examples=300)
def test_no_answer_to_a_stranger_is_longer_than_three_requests(datagram: bytes) -> None:
    server = Server()
    answers = server.answers(datagram, STRANGER)
    assert len(answers) <= 1
    assert sum(map(len, answers)) <= 3 * len(datagram)
    assert len(server.sessions) == 0


@given(st.lists(st.binary(max_size=1100) | st.text("(init bluebye)3\0 ", max_size=60).map(str.encode), max_size=8))
def test_garbage_gets_at_most_one_short_error(garbage: list[bytes]) -> None:
    server = Server()
    for datagram in garbage:
        answers = server.answers(datagram)
        if not any(answer.startswith(b"(init") for answer in answers):
            assert sum(map(len, answers)) <= 40


def test_a_flood_is_cut_off() -> None:
    server = Server()
    answered = sum(len(server.answers(b"(init green 1)")) for _ in range(1000))
    assert answered == 40
    assert server.sessions.counts.limited == 960
    server.clock.advance(1.0)
    assert server.answers(INIT) == [GRANTED]


def test_one_clients_flood_leaves_its_neighbors_allowance_alone() -> None:
    server = Server()
    opened(server)
    for _ in range(1000):
        server.hear(b"(dash)")
    opened(server, b"(init blue 4)", OTHER)


@pytest.mark.parametrize("first", [b"(see 1 2)", b"(error not_admitted)", b"(init blue 3 play_on)", INIT, b"(dash)"])
def test_two_servers_do_not_talk_for_ever(first: bytes) -> None:
    one, two = Peer("127.0.0.1", 6000), Peer("127.0.0.1", 7000)
    network = Network({one: Server(), two: Server()})
    network.put(first, one, two)
    network.run(most=50)
    assert network.travelled <= 2


def test_silence_ends_a_session_after_its_lease() -> None:
    server = Server(lease_s=600.0)
    session = opened(server)
    server.clock.advance(599.0)
    server.hear(INIT)
    server.clock.advance(600.0)
    assert server.sessions.expire(server.clock.now()) == []
    server.clock.advance(0.1)
    assert server.sessions.expire(server.clock.now()) == [SessionClosed(session, Change.SILENT)]


def test_the_operator_may_end_a_session() -> None:
    server = Server()
    session = opened(server)
    assert server.sessions.close(session) == [SessionClosed(session, Change.STOPPED)]


def test_a_restored_server_goes_on() -> None:
    """Ports, options and the order of Time outlive the process."""
    server = Server()
    opened(server, b"(init blue 3 (types team) (rate 10))\0")
    opened(server, b"(init yellow 1 (port same))", Peer("fd00::5", 7, 2))
    settled = opened(server, b"(init blue 5)", OTHER)
    server.hear(b"(init blue 5)", OTHER, SESSION)
    at = Instant(BOOT + 50_000_000)
    for session in server.sessions:
        session.note_served(at)
    restored = Sessions.restore(rules(), server.sessions.snapshot())
    assert [session.to_plain() for session in restored] == [session.to_plain() for session in server.sessions]
    assert [session.port for session in restored] == [Port.SESSION, Port.MAIN, Port.SESSION]
    assert not any(session.wants(at) for session in restored)
    assert [session.wants(after(at, 0.03)) for session in restored] == [False, True, True]
    repeated = restored.receive(b"(init blue 5)", OTHER, MAIN, server.clock.now())
    assert [type(event) for event in repeated] == [Reply]
    assert settled.peer == OTHER


@pytest.mark.parametrize("snapshot", [b"", b"{", b"[]", b"{}", b"\xff", b'{"snapshot": 1, "boot": 1, "sessions": []}'])
def test_a_foreign_snapshot_is_refused(snapshot: bytes) -> None:
    with pytest.raises(ValueError):  # noqa: PT011 (JSON's own message, or ours)
        Sessions.restore(rules(), snapshot)
