"""The server's side: every rule of the protocol, in bytes and instants."""

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.protocol.samples import (
    CLIENT,
    MAIN,
    MIRRORS,
    OTHER,
    SESSION,
    STRANGER,
    TEAMMATE,
    Network,
    Server,
    replies,
    rules,
)
from tests.protocol.test_codec import option_sets
from vision_core.models.mirror import Mirror
from vision_core.protocol.admission import Admission
from vision_core.protocol.door import ALL_INITS_RATE, STRANGER_RATE
from vision_core.protocol.encoding import encode
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import (
    Endpoint,
    LagReported,
    Reply,
    RequestRefused,
    SessionChanged,
    SessionClosed,
    SessionMoved,
    SessionOpened,
)
from vision_core.protocol.lifecycle import Peer, Port, Session, SessionTrigger
from vision_core.protocol.messages import Init, LagReport
from vision_core.protocol.options import Options
from vision_core.protocol.rate_limits import COMMAND_RATE, DATAGRAM, INVALID, RATES
from vision_core.protocol.session import Sessions
from vision_core.types.objects import Team

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
    assert not any(isinstance(event, SessionChanged) for event in server.hear(INIT))
    assert SessionChanged(session) in server.hear(b"(init blue 3 (types team))\0")
    assert session.init.options.types == "team"
    assert session.nul


def test_a_client_that_finds_us_at_another_of_our_addresses_is_answered_from_there() -> None:
    server = Server()
    server.hear(b"(init blue 3)")
    (session,) = server.sessions
    elsewhere = Endpoint(Port.MAIN, "10.0.0.3")
    events = server.hear(b"(init blue 3)", CLIENT, elsewhere)
    assert events[0] == SessionMoved(session)
    assert [event.via for event in events if isinstance(event, Reply)] == [Endpoint(Port.SESSION, "10.0.0.3")]
    assert server.hear(b"(init blue 3 (rate 5))", CLIENT, elsewhere)[0] == SessionChanged(session)


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
        server.hear(INIT, endpoint=SESSION)
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
    assert server.sessions.refused(session, server.clock.now()) == [
        SessionClosed(session, SessionTrigger.REFUSED_AT_ONCE)
    ]
    assert len(server.sessions) == 0


def test_a_later_refusal_ends_at_once_and_frees_the_robot() -> None:
    server = Server()
    session = opened(server)
    server.clock.advance(30.0)
    assert server.sessions.refused(session, server.clock.now()) == [SessionClosed(session, SessionTrigger.REFUSED)]
    assert server.sessions.refused(session, server.clock.now()) == []
    opened(server, peer=TEAMMATE)


def test_a_client_that_was_heard_on_the_session_port_is_not_moved() -> None:
    server = Server()
    session = opened(server)
    server.hear(INIT, endpoint=SESSION)
    assert server.sessions.refused(session, server.clock.now()) == [
        SessionClosed(session, SessionTrigger.REFUSED_AT_ONCE)
    ]


@pytest.mark.parametrize("endpoint", [MAIN, SESSION])
def test_bye(endpoint: Endpoint) -> None:
    server = Server()
    session = opened(server)
    assert server.hear(b"(bye)", endpoint=endpoint) == [SessionClosed(session, SessionTrigger.LEFT)]
    assert server.answers(b"(bye)") == [b"(error not_connected)"]


def test_one_socket_may_hold_several_robots_and_must_name_them() -> None:
    server = Server()
    third, fourth = opened(server), opened(server, b"(init blue 4)")
    assert server.answers(b"(bye)") == [b"(error illegal_form)"]
    assert server.hear(b"(bye blue 4)") == [SessionClosed(fourth, SessionTrigger.LEFT)]
    assert server.hear(b"(bye)") == [SessionClosed(third, SessionTrigger.LEFT)]


@pytest.mark.parametrize("endpoint", [MAIN, SESSION])
def test_a_report_is_an_event_and_gets_no_answer(endpoint: Endpoint) -> None:
    server = Server()
    session = opened(server)
    server.clock.advance(0.010)
    report = LagReport(0, 0.002, 0.0055)
    assert server.hear(b"(lag 0.000 2 5.5)", endpoint=endpoint) == [LagReported(session, report, server.clock.now())]
    assert session.heard == server.clock.now()


def test_a_report_needs_a_session() -> None:
    server = Server()
    opened(server)
    assert server.answers(b"(lag 0.000 2 5.5)", OTHER) == [b"(error not_connected)"]
    assert server.answers(b"(lag blue 4 0.000 2 5.5)") == [b"(error not_connected)"]


def test_one_socket_with_several_robots_reports_by_name() -> None:
    server = Server()
    opened(server)
    fourth = opened(server, b"(init blue 4)")
    assert server.answers(b"(lag 0.000 0 5)") == [b"(error illegal_form)"]
    (event,) = server.hear(b"(lag blue 4 0.000 0 5)")
    assert isinstance(event, LagReported)
    assert event.session is fourth


OWN_MIRROR = b"1.933098 0.00296946 360000.0"
FIELD_MIRROR = b"4.0187 0.0125935 90000.0"


@pytest.mark.parametrize("endpoint", [MAIN, SESSION])
def test_a_session_is_told_its_mirror(endpoint: Endpoint) -> None:
    server = Server()
    session = opened(server)
    (reply,) = server.hear(b"(mirror)\0", endpoint=endpoint)
    assert isinstance(reply, Reply)
    assert (reply.data, reply.to, reply.session) == (b"(mirror %s)" % FIELD_MIRROR, CLIENT, session)


def test_the_mirror_is_the_one_that_the_session_asked_for() -> None:
    server = Server()
    opened(server, b"(init blue 3 (mirror %s))" % OWN_MIRROR)
    assert server.answers(b"(mirror)") == [b"(mirror %s)" % OWN_MIRROR]
    server.hear(INIT)
    assert server.answers(b"(mirror)") == [b"(mirror %s)" % FIELD_MIRROR]


def test_one_datagram_may_open_a_session_and_ask_for_its_mirror() -> None:
    assert Server().answers(b"(init blue 3)(mirror)") == [GRANTED, b"(mirror %s)" % FIELD_MIRROR]


def test_one_socket_with_several_robots_names_the_one_whose_mirror_it_asks_for() -> None:
    """The answer repeats the name, so that two answers cannot be mistaken for each other."""
    server = Server()
    opened(server)
    opened(server, b"(init blue 4 (mirror %s))" % OWN_MIRROR)
    assert server.answers(b"(mirror)") == [b"(error illegal_form)"]
    assert server.answers(b"(mirror blue 4)(mirror blue 3)") == [
        b"(mirror blue 4 %s)" % OWN_MIRROR,
        b"(mirror blue 3 %s)" % FIELD_MIRROR,
    ]


def test_other_addresses_are_not_told_a_mirror() -> None:
    server = Server()
    opened(server)
    assert server.answers(b"(mirror)", OTHER) == [b"(error not_connected)"]
    assert server.answers(b"(mirror blue 3)", OTHER) == []  # one error in 5 s
    assert server.answers(b"(mirror)", STRANGER) == [b"(error not_admitted)"]


def test_questions_for_the_mirror_are_limited() -> None:
    server = Server()
    opened(server)
    answers = [answer for _ in range(100) for answer in server.answers(b"(mirror)")]
    assert answers.count(b"(mirror %s)" % FIELD_MIRROR) == COMMAND_RATE.burst
    assert answers.count(b"(error rate_limited)") == 1
    assert server.answers(INIT) == [GRANTED]


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
    events = server.sessions.not_opened(session, server.clock.now())
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
    for computer in range(250):
        answers += server.answers(INIT, Peer(f"10.0.0.{computer}", 5000))
    assert answers.count(b"(error already_connected)") == ALL_INITS_RATE.burst - 1
    assert answers.count(b"(error rate_limited)") == 250 - ALL_INITS_RATE.burst


@given(
    phases_s=st.lists(st.floats(0.0, 0.5), min_size=32, max_size=32),
    period_s=st.floats(0.5, 1.0),
    laptops=st.sampled_from([1, 2]),
    wrong=st.booleans(),
)
@settings(max_examples=20, deadline=None)
def test_clients_that_repeat_their_init_are_never_over_a_limit(
    phases_s: list[float], period_s: float, laptops: int, wrong: bool
) -> None:
    """After a restart all robots of both teams ask at once, and again every 0.5 to 1 s, for as long as it takes."""
    server = Server()
    robots = [(team, number) for team in ("blue", "yellow") for number in range(1, 17)]
    hosts = ["127.0.0.1", "10.0.0.8"]
    inits = sorted(
        (phase_s + turn * period_s, number % laptops, team, number)
        for (team, number), phase_s in zip(robots, phases_s, strict=True)
        for turn in range(60)
    )
    heard: set[bytes] = set()
    now_s = 0.0
    for at_s, laptop, team, number in inits:
        server.clock.advance(at_s - now_s)
        now_s = at_s
        word = "green" if wrong else team  # answered with an error each time
        port = 5000 + number + 100 * (team == "blue")
        heard.update(server.answers(f"(init {word} {number})".encode(), Peer(hosts[laptop], port)))
    assert b"(error rate_limited)" not in heard
    assert server.sessions.counts.limited == 0


def test_a_few_addresses_that_ask_without_end_leave_others_their_share() -> None:
    """Eight addresses send 800 inits a second; a ninth connects at the first attempt, each time."""
    server = Server()
    opened(server, INIT, TEAMMATE)
    greedy = [Peer(f"10.0.0.{computer}", 1) for computer in range(50, 58)]
    for turn in range(100):
        for peer in greedy * 10:
            server.hear(INIT, peer)
        if turn % 10 == 9:
            answers = server.answers(b"(init yellow 2)", Peer("10.0.0.9", 6000 + turn))
            assert b"(init yellow 2 play_on)" in answers
        server.clock.advance(0.1)


def test_what_strangers_send_is_mostly_not_even_read(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[bytes] = []
    monkeypatch.setattr("vision_core.protocol.session.decode_commands", read.append)
    server = Server()
    for number in range(5000):
        server.hear(INIT, Peer(f"192.0.{number // 250}.{number % 250}", 7))
    assert len(read) == STRANGER_RATE.burst
    assert server.sessions.counts.limited == 5000 - STRANGER_RATE.burst


def test_a_higher_version_is_answered_with_ours_and_a_warning() -> None:
    server = Server()
    cookie = server.answers(b"(init blue 3 (version 3))")[0][len("(challenge ") : -1]
    answers = server.answers(b"(init blue 3 (version 3) (novelty 1) (cookie %s))" % cookie)
    assert answers[0].startswith(GRANTED[:-1] + b" (version 2) ")
    assert answers[1:] == [b"(warning unknown_option)"]


def test_strangers_get_one_short_error_now_and_then() -> None:
    server = Server()
    assert server.answers(INIT, STRANGER) == [b"(error not_admitted)"]
    asked = RequestRefused(STRANGER, ErrorCode.NOT_ADMITTED, Team.BLUE, 3)
    assert server.hear(INIT, STRANGER) == [asked], "the operator is shown every request that is read"
    server.clock.advance(5.0)
    assert server.hear(INIT, STRANGER)[-1] == asked
    assert server.hear(b"(bye)", STRANGER) == [RequestRefused(STRANGER, ErrorCode.NOT_ADMITTED)]
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
    answers = [answer for _ in range(1000) for answer in server.answers(b"(init green 1)")]
    assert answers.count(b"(error illegal_team)") == RATES[INVALID].burst
    assert answers.count(b"(error rate_limited)") == 1
    assert server.sessions.counts.limited == 1000 - RATES[DATAGRAM].burst
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
    assert server.sessions.expire(server.clock.now()) == [SessionClosed(session, SessionTrigger.SILENT)]


def test_the_operator_may_end_a_session() -> None:
    server = Server()
    session = opened(server)
    assert server.sessions.close(session, server.clock.now()) == [SessionClosed(session, SessionTrigger.STOPPED)]


any_init = st.builds(
    lambda team, number, options, unknown: Init(
        team, number, replace(options, version=2) if unknown else options, unknown_options=unknown
    ),
    st.sampled_from(Team),
    st.integers(1, 5),
    option_sets,
    st.booleans(),
)


@given(st.lists(st.tuples(any_init, st.booleans(), st.booleans(), st.booleans()), max_size=3))
@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])
def test_restored_sessions_equal_what_was(openings: list[tuple[Init, bool, bool, bool]]) -> None:
    """Whatever clients asked for, and whatever state they reached."""
    server = Server()
    for port, (init, nul, spoke, repeated) in enumerate(openings, start=1000):
        data = encode(init)[:-1] + b" (novelty 1))" * init.unknown_options + b")" * (not init.unknown_options)
        peer = Peer("fd00::5", port, 2)
        if init.options.version > 1:
            cookie = server.answers(data, peer)[0][len("(challenge ") : -1]
            data = data[:-1] + b" (cookie %s))" % cookie
        data += b"\0" * nul
        server.hear(data, peer)
        for endpoint in [SESSION] * spoke + [MAIN] * repeated:
            server.clock.advance(0.1)
            server.hear(data, peer, endpoint)
    assert len(server.sessions) == len({(init.team, init.number) for init, *_ in openings})
    restored = Sessions.restore(rules(), server.sessions.snapshot())
    for copy, session in zip(restored, server.sessions, strict=True):
        for name in Session.__slots__:
            if name not in {"limiter", "claim", "unreachable"}:  # these begin anew
                assert getattr(copy, name) == getattr(session, name), name


def test_a_restored_server_answers_a_repeated_init() -> None:
    server = Server()
    opened(server, b"(init blue 5)", OTHER)
    restored = Sessions.restore(rules(), server.sessions.snapshot())
    repeated = restored.receive(b"(init blue 5)", OTHER, MAIN, server.clock.now())
    assert [type(event) for event in repeated] == [Reply]


@pytest.mark.parametrize("snapshot", [b"", b"{", b"[]", b"{}", b"\xff", b'{"snapshot": 2, "boot": 1, "sessions": []}'])
def test_a_foreign_snapshot_is_refused(snapshot: bytes) -> None:
    with pytest.raises(ValueError):  # noqa: PT011 (JSON's own message, or ours)
        Sessions.restore(rules(), snapshot)


def test_other_rules_hold_for_sessions_that_are_open() -> None:
    server = Server()
    server.hear(b"(init blue 3)", TEAMMATE)
    server.hear(b"(init yellow 5)")
    before = list(server.sessions)
    kept = replace(server.sessions.rules, numbers=5, mirrors=dict.fromkeys(MIRRORS, Mirror(4.2, 0.0131, 91000.0)))
    assert server.apply(kept, "pause") == []
    assert list(server.sessions) == before
    assert server.answers(b"(init blue 1)") == [b"(init blue 1 pause)"]
    assert server.answers(b"(mirror)", TEAMMATE, SESSION) == [b"(mirror 4.2 0.0131 91000.0)"]


def test_a_session_that_is_admitted_no_longer_ends_and_its_client_is_told() -> None:
    server = Server()
    server.hear(b"(init blue 3)", TEAMMATE)
    server.hear(b"(init yellow 5)")
    strict = replace(server.sessions.rules, admission=Admission(), numbers=4)
    events = server.apply(strict, "play_on")
    assert replies(events) == [b"(error not_admitted)", b"(error illegal_number)"]
    assert len(server.sessions) == 0


def test_an_address_that_is_admitted_as_one_robot_is_not_admitted_as_another() -> None:
    server = Server()
    own = Admission.from_texts([], [("10.0.0.7", Team.BLUE, 3)], [])
    server.apply(replace(server.sessions.rules, admission=own), "play_on")
    assert server.answers(b"(init blue 3)", TEAMMATE) == [b"(init blue 3 play_on)"]
    other = server.hear(b"(init blue 4)", TEAMMATE)
    assert replies(other) == [b"(error not_admitted)"]
    assert RequestRefused(TEAMMATE, ErrorCode.NOT_ADMITTED, Team.BLUE, 4) in other


def test_a_match_fixes_the_mirror_and_says_so() -> None:
    """A client that has asked for a mirror of its own is told when the match begins, and at each init of the match."""
    server = Server()
    asks = b"(init blue 3 (mirror %s))" % OWN_MIRROR
    opened(server, asks)
    opened(server, b"(init yellow 1)", OTHER)
    practice = server.sessions.rules
    match = replace(practice, fixed=Options())
    assert replies(server.apply(match, "play_on")) == [b"(warning fixed_by_match)"]
    assert server.apply(match, "play_on") == []
    assert server.answers(b"(mirror)") == [b"(mirror %s)" % FIELD_MIRROR]
    assert server.answers(asks) == [GRANTED, b"(warning fixed_by_match)"]
    assert server.apply(practice, "play_on") == []
    assert server.answers(asks + b"(mirror)") == [GRANTED, b"(mirror %s)" % OWN_MIRROR]


def test_a_robot_may_have_another_mirror_than_its_team() -> None:
    server = Server()
    opened(server)
    opened(server, b"(init blue 4)")
    own = {**MIRRORS, (Team.BLUE, 4): Mirror(4.2, 0.0131, 91000.0)}
    server.apply(replace(server.sessions.rules, mirrors=own), "play_on")
    assert server.answers(b"(mirror blue 3)(mirror blue 4)") == [
        b"(mirror blue 3 %s)" % FIELD_MIRROR,
        b"(mirror blue 4 4.2 0.0131 91000.0)",
    ]
