"""Version 2: proofs, facts, changes while a session lives, clocks, and what a match fixes."""

import re
from dataclasses import replace

import pytest

from tests.protocol.samples import BOOT, CLIENT, FACTS, MAIN, MIRRORS, OTHER, SESSION, STRANGER, Server, replies
from vision_core.models.mirror import Mirror
from vision_core.protocol.answers import decode_message
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import RequestRefused, SessionChanged, SessionClosed, SyncAsked
from vision_core.protocol.lifecycle import Peer, SessionTrigger
from vision_core.protocol.messages import Challenge, InitReply, MirrorReply, Sync
from vision_core.protocol.options import Options
from vision_core.protocol.proofs import EPOCH_S, key_digest
from vision_core.protocol.rate_limits import AMPLIFICATION, COMMAND_RATE
from vision_core.protocol.rules import VERSION_2_LEASE_S
from vision_core.types.objects import Team

INIT = b"(init blue 3)"
INIT_2 = b"(init blue 3 (version 2))"
KEY = "Zx-9_" + "k" * 38
KEYS = {Team.BLUE: key_digest(KEY)}
WITH_KEY = b"(init blue 3 (version 2) (key %s))" % KEY.encode()


def cookie_of(answers: list[bytes]) -> bytes:
    (challenge,) = answers
    message = decode_message(challenge)
    assert isinstance(message, Challenge)
    assert re.fullmatch("[0-9a-f]{24}", message.cookie)
    return message.cookie.encode()


def with_cookie(datagram: bytes, cookie: bytes) -> bytes:
    return datagram[:-1] + b" (cookie %s))" % cookie


def test_an_address_has_to_prove_itself_before_it_gets_a_session() -> None:
    server = Server()
    challenge = server.answers(INIT_2)
    assert len(challenge[0]) <= AMPLIFICATION * len(INIT)
    assert len(server.sessions) == 0
    (granted,) = server.answers(with_cookie(INIT_2, cookie_of(challenge)))
    assert granted.startswith(b"(init blue 3 play_on (version 2) ")
    assert [session.peer for session in server.sessions] == [CLIENT]


@pytest.mark.parametrize("other", [OTHER, Peer("127.0.0.2", CLIENT.port)])
def test_a_cookie_is_of_one_address_and_port(other: Peer) -> None:
    server = Server()
    cookie = cookie_of(server.answers(INIT_2))
    assert cookie_of(server.answers(with_cookie(INIT_2, cookie), other)) != cookie
    assert len(server.sessions) == 0


@pytest.mark.parametrize(("age_s", "holds"), [(EPOCH_S, True), (2 * EPOCH_S, False), (100 * EPOCH_S, False)])
def test_a_cookie_expires(age_s: float, holds: bool) -> None:
    server = Server()
    cookie = cookie_of(server.answers(INIT_2))
    server.clock.advance(age_s)
    server.hear(with_cookie(INIT_2, cookie))
    assert len(server.sessions) == int(holds)


def test_a_cookie_with_another_digit_is_refused() -> None:
    server = Server()
    cookie = cookie_of(server.answers(INIT_2))
    for place in range(len(cookie)):
        flipped = bytearray(cookie)
        flipped[place] = ord("0") if flipped[place] != ord("0") else ord("1")
        assert isinstance(decode_message(server.answers(with_cookie(INIT_2, bytes(flipped)))[0]), Challenge)
        server.clock.advance(0.1)
    assert len(server.sessions) == 0


def test_the_answer_tells_all_that_a_client_has_to_know() -> None:
    server = Server()
    granted = decode_message(replies(server.open_2(b"(init blue 3 (types team))"))[0])
    assert isinstance(granted, InitReply)
    facts = granted.facts
    assert facts is not None
    assert (facts.version, facts.session, facts.lease_s, facts.types) == (2, 6001, VERSION_2_LEASE_S, "team")
    assert (facts.mirror, facts.rmin_mm, facts.rmax_mm) == (MIRRORS[Team.BLUE, 3], 90.0, 3600.0)
    assert (facts.fov_deg, facts.center_deg, facts.resolution_deg) == (360.0, 180.0, 1.0)
    assert (facts.clock_ns, facts.boot) == (server.clock.now() - BOOT, f"{BOOT:x}")
    assert (facts.venue, facts.field_mm) == (FACTS.venue, FACTS.field_mm)
    assert facts.period_ms == pytest.approx(FACTS.period_ms, rel=1e-4)


def test_a_paper_only_client_hears_the_paper_only() -> None:
    server = Server()
    assert server.answers(INIT) == [b"(init blue 3 play_on)"]
    assert server.apply(server.sessions.rules, "pause") == []
    assert server.sessions.tell("vision_lost", server.clock.now()) == []


def test_a_session_of_version_2_lives_for_15_s_without_a_word() -> None:
    server = Server()
    server.open_2(INIT)
    (session,) = server.sessions
    server.clock.advance(VERSION_2_LEASE_S)
    assert server.answers(b"(ping 7)", CLIENT, SESSION) == [b"(pong 7)"]
    server.clock.advance(VERSION_2_LEASE_S)
    assert server.sessions.expire(server.clock.now()) == []
    server.clock.advance(0.1)
    assert server.sessions.expire(server.clock.now()) == [SessionClosed(session, SessionTrigger.SILENT)]


def test_options_change_while_the_session_lives() -> None:
    server = Server()
    server.open_2(b"(init blue 3 (types team))")
    events = server.hear(b"(set (rate 10) (extra seq flags))", CLIENT, SESSION)
    assert isinstance(events[0], SessionChanged)
    assert replies(events) == [b"(ok set)"]
    (session,) = server.sessions
    assert (session.options.rate_hz, session.options.types, session.options.extras) == (10, "team", ("seq", "flags"))
    assert server.answers(b"(set blue 3 (novelty 1))", CLIENT, SESSION) == [b"(ok set)", b"(warning unknown_option)"]


@pytest.mark.parametrize(
    ("change", "error"),
    [
        (b"(set (rate 0))", b"illegal_option"),
        (b"(set (version 1))", b"illegal_option"),
        (b"(set (port same))", b"illegal_option"),
        (b"(set (mirror 1 1 1))", b"illegal_mirror"),
        (b"(set (mirror 1 0.01 90000))", b"illegal_mirror"),
        (b"(set (extra seq seq))", b"illegal_option"),
        (b"(set (fov 360) (resolution 0.25))", b"illegal_option"),
        (b"(set (fov 112) (resolution 0.25) (extra flags))", b"illegal_option"),
        (b"(set red 3 (rate 5))", b"illegal_team"),
        (b"(set blue 4 (rate 5))", b"not_connected"),
    ],
)
def test_a_bad_change_is_refused_and_changes_nothing(change: bytes, error: bytes) -> None:
    server = Server()
    server.open_2(INIT)
    (session,) = server.sessions
    before = session.options
    assert server.answers(change, CLIENT, SESSION) == [b"(error %s)" % error]
    assert session.options == before


@pytest.mark.parametrize(
    "forged", [INIT, b"(init blue 3 (rate 1))", b"(init blue 3 (version 2) (rate 1))", b"(init blue 3 (version 2))\0"]
)
def test_an_init_in_the_owners_name_without_its_cookie_changes_nothing(forged: bytes) -> None:
    server = Server()
    server.open_2(INIT)
    (session,) = server.sessions
    before = session.to_plain()
    (told,) = server.answers(forged)
    assert told.startswith((b"(challenge ", b"(error illegal_option)"))
    assert session.to_plain() == before


def test_extras_belong_to_version_2() -> None:
    assert Server().answers(b"(init blue 3 (extra seq))") == [b"(error illegal_option)"]


def test_the_clock_is_told_to_sessions_only() -> None:
    server = Server()
    assert server.answers(b"(sync 7 -5)") == [b"(error not_connected)"]
    server.open_2(INIT)
    (session,) = server.sessions
    assert server.hear(b"(sync 7 -5)", CLIENT, SESSION) == [SyncAsked(session, Sync(7, -5), server.clock.now())]
    asked = [event for _ in range(100) for event in server.hear(b"(sync 8 1)", CLIENT, SESSION)]
    assert sum(isinstance(event, SyncAsked) for event in asked) == COMMAND_RATE.burst - 1


def test_a_change_of_play_mode_is_heard() -> None:
    server = Server()
    server.open_2(INIT)
    server.hear(b"(init yellow 1)", OTHER)
    server.clock.advance(1.5)
    time = b"%d.%03d" % divmod((server.clock.now() - BOOT) // 1_000_000, 1000)
    assert replies(server.apply(server.sessions.rules, "pause")) == [b"(hear %s referee pause)" % time]
    assert server.apply(server.sessions.rules, "pause") == []
    lost = server.sessions.tell("vision_lost", server.clock.now())
    assert replies(lost) == [b"(hear %s referee vision_lost)" % time]


def test_a_changed_mirror_is_told() -> None:
    server = Server()
    server.open_2(INIT)
    server.open_2(b"(init blue 4 (mirror 4.1 0.013 90000))", OTHER)
    other = dict.fromkeys(MIRRORS, Mirror(4.2, 0.0131, 91000.0))
    told = replies(server.apply(replace(server.sessions.rules, mirrors=other)))
    assert [datagram.partition(b" mirror ")[2] for datagram in told] == [b"4.2 0.0131 91000.0)"]


def test_a_match_gives_all_robots_the_same_view() -> None:
    server = Server()
    wants = b"(types number) (rate 200) (fov 90) (resolution 0.25) (mirror 4.1 0.013 90000) (time us)"
    server.open_2(b"(init blue 3 %s)" % wants)
    server.hear(b"(init yellow 1)", OTHER)
    fixed = Options(types="team", fov_deg=180.0, center_deg=0.0, resolution_deg=2.0, rate_hz=30)
    told = replies(server.apply(replace(server.sessions.rules, fixed=fixed)))
    assert told[0] == b"(warning fixed_by_match)"
    granted = decode_message(told[1])
    assert isinstance(granted, InitReply)
    assert granted.facts is not None
    assert (granted.facts.types, granted.facts.fov_deg, granted.facts.resolution_deg) == ("team", 180.0, 2.0)
    assert not any(datagram.startswith(b"(init yellow") for datagram in told)  # version 1 hears the paper only
    assert {replace(session.options, time="ms", version=1) for session in server.sessions} == {fixed}
    assert server.answers(b"(set (types same))", CLIENT, SESSION) == [b"(ok set)", b"(warning fixed_by_match)"]
    server.apply(replace(server.sessions.rules, fixed=None))
    (blue,) = (session for session in server.sessions if session.team is Team.BLUE)
    assert (blue.options.types, blue.options.fov_deg, blue.options.rate_hz) == ("same", 90.0, 200)


def test_the_key_of_the_team_opens_the_door_to_an_address_that_is_not_admitted() -> None:
    server = Server(keys=KEYS)
    cookie = cookie_of(server.answers(WITH_KEY, STRANGER))
    assert len(server.sessions) == 0
    (granted,) = server.answers(with_cookie(WITH_KEY, cookie), STRANGER)
    assert granted.startswith(b"(init blue 3 play_on (version 2)")
    assert server.answers(b"(ping)", STRANGER, SESSION) == [b"(pong)"]


@pytest.mark.parametrize(
    "datagram",
    [
        WITH_KEY.replace(b"Zx", b"zx"),  # letter case counts in a key
        WITH_KEY.replace(b"blue", b"yellow"),
        INIT_2,
        INIT[:-1] + b" (key %s))" % KEY.encode(),  # version 1 proves no address
    ],
)
def test_without_the_right_key_a_stranger_is_turned_away(datagram: bytes) -> None:
    server = Server(keys=KEYS)
    first = server.hear(datagram, STRANGER)
    if b"challenge" in replies(first)[0]:
        first = server.hear(with_cookie(datagram, cookie_of(replies(first))), STRANGER)
    assert replies(first) == [b"(error not_admitted)"]
    assert any(isinstance(event, RequestRefused) for event in first)
    assert len(server.sessions) == 0


def test_a_wrong_key_is_named_to_an_admitted_client() -> None:
    server = Server(keys=KEYS)
    wrong = WITH_KEY.replace(b"kkk", b"jjj")
    cookie = cookie_of(server.answers(wrong))
    assert server.answers(with_cookie(wrong, cookie)) == [b"(error wrong_key)"]
    assert len(server.sessions) == 0


def test_no_key_is_ever_shown() -> None:
    server = Server(keys=KEYS)
    cookie = cookie_of(server.answers(WITH_KEY))
    server.hear(with_cookie(WITH_KEY, cookie))
    (session,) = server.sessions
    assert KEY not in repr(session) + server.sessions.snapshot().decode()


def test_a_new_key_ends_what_the_old_one_opened() -> None:
    server = Server(keys=KEYS)
    cookie = cookie_of(server.answers(WITH_KEY, STRANGER))
    server.hear(with_cookie(WITH_KEY, cookie), STRANGER)
    told = replies(server.apply(replace(server.sessions.rules, keys={Team.BLUE: key_digest("another")})))
    assert told == [b"(error not_admitted)"]
    assert len(server.sessions) == 0


def test_a_team_goes_on_with_its_robot_from_another_address() -> None:
    """Its options stay; without the key nothing happens, also after an error."""
    server = Server(keys=KEYS)
    server.open_2(b"(init blue 3 (types number))")
    again = b"(reconnect blue 3 (key %s))" % KEY.encode()
    told = replies(server.hear(with_cookie(again, cookie_of(server.answers(again, STRANGER))), STRANGER))
    assert told[0] == b"(error replaced)"
    assert b"(types number)" in told[1]
    (session,) = server.sessions
    assert session.peer == STRANGER


@pytest.mark.parametrize(
    ("datagram", "error"),
    [
        (b"(reconnect blue 3)", ErrorCode.ILLEGAL_OPTION),
        (b"(reconnect blue 3 (key nonsense))", ErrorCode.WRONG_KEY),
        (b"(reconnect blue 4 (key %s))" % KEY.encode(), ErrorCode.NOT_CONNECTED),
    ],
)
def test_a_bad_reconnect_ends_with_its_error(datagram: bytes, error: ErrorCode) -> None:
    server = Server(keys=KEYS)
    server.open_2(INIT)
    answers = server.answers(datagram, OTHER, MAIN)
    if b"challenge" in answers[0]:
        answers = server.answers(with_cookie(datagram, cookie_of(answers)), OTHER)
    assert answers == [b"(error %s)" % error.encode()]
    assert [session.peer for session in server.sessions] == [CLIENT]


def test_the_mirror_may_still_be_asked_for() -> None:
    server = Server()
    server.open_2(INIT)
    (told,) = server.answers(b"(mirror)", CLIENT, SESSION)
    assert decode_message(told) == MirrorReply(MIRRORS[Team.BLUE, 3])
