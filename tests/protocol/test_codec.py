"""Messages to bytes and back; and whatever else may come in."""

import time
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.protocol.answers import decode_message
from vision_core.protocol.commands import SERVER_WORDS, decode_commands
from vision_core.protocol.encoding import encode, encode_see
from vision_core.protocol.error_codes import MEANINGS, ErrorCode
from vision_core.protocol.messages import (
    HIDDEN,
    PLAY_MODES,
    Ball,
    Bye,
    Challenge,
    ErrorReply,
    Hear,
    Init,
    InitReply,
    InvalidCommand,
    LagReport,
    MirrorQuery,
    MirrorReply,
    Ok,
    Ping,
    Pong,
    Reconnect,
    Request,
    See,
    ServerMessage,
    SessionFacts,
    Set,
    Sync,
    SyncReply,
    WarningReply,
)
from vision_core.protocol.options import MAX_DIRECTIONS, Options
from vision_core.protocol.proofs import Proof
from vision_core.types.objects import Team

BLUE_3 = Init(Team.BLUE, 3)
DEFINITELY_BOUNDED_S = 0.5
"""Far above what is promised (1 ms), far below what recursion or backtracking would take."""

quarters = st.integers(1, 1440).map(lambda n: n / 4)
option_sets = st.builds(
    Options,
    version=st.integers(1, 9),
    types=st.sampled_from(["same", "team", "number"]),
    mirror=st.sampled_from([None, PAPER_MIRROR, Mirror(1.933098, 0.00296946, 360000.0)]),
    fov_deg=quarters,
    center_deg=st.integers(-1440, 1440).map(lambda n: n / 4),
    resolution_deg=quarters,
    rate_hz=st.none() | st.integers(1, 1000),
    time=st.sampled_from(["ms", "us"]),
    size=st.sampled_from(["full", "half"]),
    sense=st.sampled_from(["ccw", "cw"]),
    port_same=st.booleans(),
).filter(lambda o: 1 <= o.directions <= MAX_DIRECTIONS and (o.first_deg * 4).is_integer())
robots = st.tuples(st.sampled_from(Team), st.integers(1, 16))
edge = st.tuples(st.sampled_from("wuvqrxyAPap-"), st.integers(0, 255)).map(lambda e: f"{e[0]}{e[1]:02x}".encode())
balls = st.just(HIDDEN) | st.builds(Ball, st.integers(0, 254), st.integers(0, 359), st.integers(1, 180))
shares_s = st.integers(0, 10**7).map(lambda us: us / 1e6)
lags = st.builds(LagReport, st.integers(0, 10**15), shares_s, st.none() | shares_s)
sees = st.builds(See, st.integers(0, 10**15), st.lists(edge, max_size=448).map(b"".join), balls)


def only(datagram: bytes) -> object:
    request = decode_commands(datagram)
    assert request is not None
    assert len(request.commands) == 1
    return request.commands[0]


@pytest.mark.parametrize(
    "datagram",
    [
        b"(init blue 3)",
        b"(init (team blue) (number 3))",
        b"(init blue (number 3))",
        b"(INIT Blue 3)",
        b"  ( init\tblue\r\n3 )\n",
        b"(init blue 3 (version 1))",
    ],
)
def test_every_accepted_form_of_init(datagram: bytes) -> None:
    assert only(datagram) == BLUE_3
    assert decode_commands(datagram) == Request((BLUE_3,), nul=False)
    assert decode_commands(datagram + b"\0") == Request((BLUE_3,), nul=True)


@given(robots, option_sets)
def test_init_survives_the_wire(robot: tuple[Team, int], options: Options) -> None:
    init = Init(*robot, options)
    assert only(encode(init)) == init


@given(sees, st.booleans())
def test_see_survives_the_wire(see: See, nul: bool) -> None:
    assert decode_message(encode_see(see, "us") + b"\0" * nul) == see


@pytest.mark.parametrize(
    "message",
    [
        InitReply(Team.YELLOW, 16, "before_kick_off"),
        WarningReply("unknown_option"),
        *(ErrorReply(name) for name in ErrorCode),
    ],
)
def test_short_server_messages_survive_the_wire(message: InitReply | ErrorReply | WarningReply) -> None:
    datagram = encode(message)
    assert decode_message(datagram) == message
    assert len(datagram) <= 39


@pytest.mark.parametrize(
    "command",
    [
        Bye(),
        Bye(Team.BLUE, 3),
        Ping(),
        Ping(7),
        Sync(7, -(2**63)),
        Set((("rate", "10"), ("fov", "90", "0"))),
        Set((("types", "team"),), Team.YELLOW, 16),
        Reconnect(Team.BLUE, 3, Proof("0123456789abcdef01234567", "Key-_9")),
    ],
)
def test_a_command_survives_the_wire(command: Bye | Ping | Sync | Set | Reconnect) -> None:
    assert only(encode(command)) == command


@pytest.mark.parametrize(
    "message",
    [
        Challenge("0123456789abcdef01234567"),
        Hear(1_500_000, "referee", ("kick_off_l",)),
        Ping(3),
        Pong(),
        Pong(7),
        SyncReply(7, -5, 2**62, 2**62 + 1),
        Ok("set"),
    ],
)
def test_a_message_of_version_2_survives_the_wire(message: ServerMessage) -> None:
    datagram = encode(message)  # type: ignore[arg-type]
    assert decode_message(datagram) == message
    answered = decode_commands(datagram)
    assert answered is None or isinstance(message, Ping)  # servers do not answer each other for ever


@pytest.mark.parametrize(
    "datagram",
    [b"(sync 7)", b"(sync 7 1 2)", b"(sync a b)", b"(sync 7 99999999999999999999)", b"(ping x)", b"(ping 1 2)"],
)
def test_a_command_with_wrong_words_is_named(datagram: bytes) -> None:
    request = decode_commands(datagram)
    assert request is None or request.commands == (InvalidCommand(ErrorCode.ILLEGAL_FORM),)


@pytest.mark.parametrize(
    "proof",
    [b"(cookie 12)", b"(cookie 0123456789abcdef0123456g)", b"(key a) (key b)", b"(key)", b"(key %s)" % (b"k" * 129)],
)
def test_an_illegal_proof_is_an_illegal_option(proof: bytes) -> None:
    assert only(b"(init blue 3 (version 2) %s)" % proof) == InvalidCommand(ErrorCode.ILLEGAL_OPTION)


def test_an_answer_to_init_with_all_its_pairs_survives_the_wire() -> None:
    facts = SessionFacts(
        2, 6001, 15.0, 33.25, PAPER_MIRROR, 90.0, 3620.5, 90.0, -0.25, 0.25, "team", 2**62, "4a817c800", "ssl-lab_2",
        (2800.0, 2300.0),
    )  # fmt: skip
    reply = InitReply(Team.BLUE, 3, "play_on", facts)
    assert decode_message(encode(reply)) == reply
    assert decode_commands(encode(reply)) is None
    assert len(encode(reply)) < 400


@pytest.mark.parametrize("mode", sorted(PLAY_MODES))
def test_no_answer_to_an_init_is_answered(mode: str) -> None:
    assert decode_commands(b"(init blue 3 %s)" % mode.encode()) is None


mirrors = st.sampled_from(
    [PAPER_MIRROR, Mirror(1.933098, 0.00296946, 360000.0), Mirror(4.0 + 1 / 3, 0.04 / 3, 9e4 + 1 / 7)]
)


@given(mirrors, st.none() | robots)
def test_a_mirror_survives_the_wire(mirror: Mirror, robot: tuple[Team, int] | None) -> None:
    """To the last digit; and a server does not answer it: it is not the question, nor the option of init."""
    reply = MirrorReply(mirror, *(robot or (None, None)))
    assert decode_message(encode(reply)) == reply
    assert decode_message(encode(reply)[:-1] + b" (boot 7))\0") == reply
    assert decode_commands(encode(reply)) is None


@pytest.mark.parametrize("query", [MirrorQuery(), MirrorQuery(Team.BLUE, 3)])
def test_a_question_for_the_mirror_survives_the_wire(query: MirrorQuery) -> None:
    assert only(encode(query)) == query
    assert decode_message(encode(query)) is None


@pytest.mark.parametrize(
    "words",
    [b"1 2", b"0 0 0", b"nan 0.01 90000", b"blue 4.0187 0.0125935 90000", b"blue 0 4.0187 0.0125935 90000", b"blue"],
)
def test_what_is_no_mirror_is_no_answer(words: bytes) -> None:
    assert decode_message(b"(mirror %s)" % words) is None


@given(lags, st.none() | robots)
def test_a_report_survives_the_wire(lag: LagReport, robot: tuple[Team, int] | None) -> None:
    sent = lag if robot is None else replace(lag, team=robot[0], number=robot[1])
    heard = only(encode(sent))
    assert isinstance(heard, LagReport)
    assert replace(heard, hold_s=0.0, client_s=None) == replace(sent, hold_s=0.0, client_s=None)
    assert heard.hold_s == pytest.approx(sent.hold_s)
    assert heard.client_s == (None if sent.client_s is None else pytest.approx(sent.client_s))


@pytest.mark.parametrize("time", [b"20306.148", b"20306.148000", b"020306.1480009"])
def test_a_report_may_print_time_in_its_own_way(time: bytes) -> None:
    assert only(b"(LAG %s .5 -)" % time) == LagReport(20306_148000, 0.0005, None)
    assert only(b"(lag (team blue) 3 %s 5e-1 1.)" % time) == LagReport(20306_148000, 0.0005, 0.001, Team.BLUE, 3)


@pytest.mark.parametrize(
    ("datagram", "error"),
    [
        (b"(init)", ErrorCode.ILLEGAL_TEAM),
        (b"(init green 3)", ErrorCode.ILLEGAL_TEAM),
        (b"(init TeamName (version 9))", ErrorCode.ILLEGAL_TEAM),
        (b"(init blue)", ErrorCode.ILLEGAL_NUMBER),
        *((b"(init blue %s)" % number, ErrorCode.ILLEGAL_NUMBER) for number in (b"0", b"-1", b"03", b"17", b"3.0")),
        (b"(init blue 99999999999999999999)", ErrorCode.ILLEGAL_NUMBER),
        (b"(init blue three)", ErrorCode.ILLEGAL_NUMBER),
        (b"(init blue 3 types)", ErrorCode.ILLEGAL_OPTION),
        (b"(init blue 3 (types rainbow))", ErrorCode.ILLEGAL_OPTION),
        (b"(init blue 3 (nonsense 1))", ErrorCode.ILLEGAL_OPTION),
        (b"(init blue 3 (mirror 1 2))", ErrorCode.ILLEGAL_MIRROR),
        (b"(bye blue)", ErrorCode.ILLEGAL_FORM),
        (b"(bye pink 3)", ErrorCode.ILLEGAL_TEAM),
        *(
            (b"(lag %s)" % words, ErrorCode.ILLEGAL_FORM)
            for words in (
                b"",
                b"1.0",
                b"1.0 0.1",
                b"1.0 0.1 2 3",
                b"blue 1.0 0.1 2",
                b"-1.0 0.1 2",
                b"1e3 0.1 2",
                b"(1.0) 0.1 2",
                b"1.0 - 2",
                b"1.0 nan 2",
                b"1.0 0.1 inf",
                b"1.0 0.1 (2)",
                b"99999999999 0.1 2",
            )
        ),
        (b"(mirror blue)", ErrorCode.ILLEGAL_FORM),
        (b"(mirror pink 3)", ErrorCode.ILLEGAL_TEAM),
        (b"(mirror 4.0187 0.0125935)", ErrorCode.ILLEGAL_TEAM),
        (b"(lag pink 3 1.0 0.1 2)", ErrorCode.ILLEGAL_TEAM),
        (b"(lag blue 0 1.0 0.1 2)", ErrorCode.ILLEGAL_NUMBER),
        (b"()", ErrorCode.ILLEGAL_FORM),
        (b"((init) blue 3)", ErrorCode.ILLEGAL_FORM),
        (b"(init blue 3", ErrorCode.ILLEGAL_FORM),
        (b"(init blue 3))", ErrorCode.ILLEGAL_FORM),
        (b"(init blue 3) x", ErrorCode.ILLEGAL_FORM),
        (b"(init bl\0ue 3)", ErrorCode.ILLEGAL_FORM),
        ("(init bl\u00fce 3)".encode(), ErrorCode.ILLEGAL_FORM),
        (b"(bye)" * 17, ErrorCode.ILLEGAL_FORM),
        (b"(teleport home)", ErrorCode.UNKNOWN_COMMAND),
    ],
)
def test_what_is_wrong_is_named(datagram: bytes, error: ErrorCode) -> None:
    assert only(datagram) == InvalidCommand(error)


def test_a_datagram_may_hold_several_forms() -> None:
    assert decode_commands(b"(init blue 3) (bye)") == Request((BLUE_3, Bye()), nul=False)


@pytest.mark.parametrize("word", sorted(SERVER_WORDS))
def test_what_a_server_said_deserves_no_answer(word: bytes) -> None:
    assert decode_commands(b"(%s 1 2)" % word) is None
    assert decode_commands(b" ( %s)" % word.upper()) is None


def test_an_answer_to_init_deserves_no_answer() -> None:
    assert decode_commands(encode(InitReply(Team.BLUE, 3, "play_on"))) is None


def test_a_higher_version_may_ask_for_more() -> None:
    init = only(b"(init blue 3 (version 3) (novelty 1) (types team))")
    assert init == Init(Team.BLUE, 3, Options(version=3, types="team"), unknown_options=True)
    assert only(b"(init blue 3 (extra seq age))") == InvalidCommand(ErrorCode.ILLEGAL_OPTION)


def test_the_papers_sample() -> None:
    sample = b"(see 20306.148 ((edge) r59r5ar5av3e...) ((ball) 61 121 3))"
    assert decode_message(sample) == See(20306_148000, b"r59r5ar5av3e", Ball(61, 121, 3))
    printed = "(see 20306.148 ((edge) r59r5ar5av3e\u00b7 \u00b7 \u00b7 ) ((ball) 61 121 3))".encode()
    assert decode_message(printed) == decode_message(sample)


def test_extras_follow_the_ball() -> None:
    see = decode_message(b"(see 1.5 ((edge) w10-ff) ((ball) -1 0 0) ((seq) 7) ((flags) nopose))\0")
    assert see == See(1_500000, b"w10-ff", HIDDEN, {"seq": ("7",), "flags": ("nopose",)})
    assert encode_see(see) == b"(see 1.500 ((edge) w10-ff) ((ball) -1 0 0) ((seq) 7) ((flags) nopose))"


def test_what_a_later_version_appends_is_passed_over() -> None:
    assert isinstance(decode_message(b"(see 1.5 ((edge) w10-ff) ((ball) -1 0 0) ((map) (a b)))"), See)
    reply = decode_message(b"(init blue 3 play_on (session 8f) (mirror 4.0 0.01 90000))")
    assert reply == InitReply(Team.BLUE, 3, "play_on")


def test_every_error_has_a_meaning() -> None:
    assert set(MEANINGS) == set(ErrorCode)


@given(st.binary(max_size=1400) | st.text(alphabet="(see init lag)blue 3.\0-wff\n", max_size=200).map(str.encode))
def test_garbage_is_no_exception(garbage: bytes) -> None:
    request = decode_commands(garbage)
    assert request is None or request.commands
    decode_message(garbage)


@given(sees, st.integers(0, 1200), st.binary(min_size=1, max_size=3))
def test_a_damaged_see_is_no_exception(see: See, where: int, damage: bytes) -> None:
    intact = encode_see(see)
    message = decode_message(intact[:where] + damage + intact[where + len(damage) :])
    assert message is None or isinstance(message, See)


@pytest.mark.parametrize(
    "datagram",
    [
        b"",
        b"(",
        b"\0" * 65507,
        b"(" * 65507,
        b"(" * 10_000 + b")" * 10_000,
        b"(" * 512 + b")" * 512,
        b"(a" * 500,
        b"(init blue 3 " + b"(types same)" * 80,
        b"(init blue 3 (mirror " + b"1" * 900 + b" nan inf))",
        b"(see 1.0 ((edge) " + b"w10" * 450 + b"!" * 500 + b"(",
        b"(see 1.0 ((edge) " + b" " * 1900,
        b"(see " + b"9" * 2000,
        b"(see 1.0 ((edge) w10) ((ball) 1 2 3) " + b")" * 1800 + b"x",
        b" " * 1024,
    ],
)
def test_hostile_datagrams_take_bounded_time(datagram: bytes) -> None:
    begun = time.process_time()
    decode_commands(datagram)
    assert not isinstance(decode_message(datagram), See) or datagram.endswith(b")")
    assert time.process_time() - begun < DEFINITELY_BOUNDED_S


def test_long_datagrams_are_not_looked_at() -> None:
    init = b"(init blue 3)"
    assert decode_commands(init.ljust(1024)) is not None
    assert decode_commands(init.ljust(1025)) is None
