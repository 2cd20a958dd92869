"""Rules of version 2."""

import re

from vision_core.examination.conformance.probe import Broken, Probe, Received, Skipped, shown
from vision_core.examination.conformance.rule import RuleBook
from vision_core.examination.conformance.views import read
from vision_core.protocol.answers import decode_message
from vision_core.protocol.messages import InitReply, SessionFacts
from vision_core.protocol.options import EXTRAS
from vision_core.protocol.rate_limits import AMPLIFICATION

BOOK = RuleBook()
CHALLENGE = r"\(challenge [0-9a-f]{24}\)"
SHORTEST_INIT = len("(init blue 3)")


def facts_of(answer: Received) -> SessionFacts:
    """What an answer tells. Raises Broken."""
    message = decode_message(answer.text.encode("latin-1"))
    if not isinstance(message, InitReply) or message.facts is None:
        raise Broken(f"(init ...) with all pairs of the table expected; {shown(answer.text)} came")
    return message.facts


@BOOK.rule("The first answer is `(challenge 0123456789abcdef01234567)`.")
def an_address_is_challenged(probe: Probe) -> None:
    with probe.client() as client:
        client.open_2()
    with probe.client() as client:
        answer = client.expect(probe.init("(version 2)"), CHALLENGE)
        if len(answer.text) > AMPLIFICATION * SHORTEST_INIT:
            raise Broken(f"at most {AMPLIFICATION * SHORTEST_INIT} bytes expected; {len(answer.text)} came")


@BOOK.rule("within a minute and from the same socket.")
def a_cookie_is_of_one_socket(probe: Probe) -> None:
    with probe.client() as client:
        client.open_2()
    with probe.client() as one, probe.client() as other:
        answer = one.expect(probe.init("(version 2)"), CHALLENGE)
        other.expect(probe.init(f"(version 2) (cookie {answer.text[11:-1]})"), CHALLENGE)


@BOOK.rule("**The answer to init tells what you have to know**")
def the_answer_tells_what_the_client_has_to_know(probe: Probe) -> None:
    with probe.client() as client:
        answer = client.open_2()
        facts = facts_of(answer)
        if facts.session != answer.port:
            raise Broken(f"(session {answer.port}) expected, the port that answers; (session {facts.session}) came")
        if not (
            facts.lease_s > 0 and facts.period_ms > 0 and 0 < facts.rmin_mm < facts.rmax_mm and min(facts.field_mm) > 0
        ):
            raise Broken(f"positive lease, period, rmin below rmax and field expected; {shown(answer.text)} came")


@BOOK.rule("a higher one is answered with the highest the server speaks.")
def a_higher_version_is_answered(probe: Probe) -> None:
    with probe.client() as client:
        client.open_2()
    with probe.client() as client:
        init = probe.init("(version 99)")
        challenge = client.expect(init, CHALLENGE)
        answer = client.ask(f"{init[:-1]} (cookie {challenge.text[11:-1]}))")
        client.served_from = answer.port
        if not 2 <= facts_of(answer).version < 99:
            raise Broken(f"the highest version that the server speaks expected; {shown(answer.text)} came")


@BOOK.rule("From version 2 on, options that the server does not know are ignored, with `(warning unknown_option)`")
def unknown_options_are_warned_of(probe: Probe) -> None:
    with probe.client() as client:
        client.open_2("(novelty 1)")
        told = client.answer()
        if told is None or told.text != "(warning unknown_option)":
            raise Broken(f"(warning unknown_option) expected; {told.text if told else 'nothing'} came")


@BOOK.rule(
    "is answered with `(ok set)`, or with the errors of init. Only `version`, `port`, `cookie` and `key` cannot be set."
)
def options_change(probe: Probe) -> None:
    with probe.client() as client:
        client.open_2()
        client.expect("(set (time us))", r"\(ok set\)")
        client.view()  # it may have been sent before
        if len(read(client.view())[2]) != 6:
            raise Broken("six decimals expected after (set (time us)); a view with others came")
        client.expect_error("(set (rate 0))", "illegal_option")
        client.expect_error("(set (version 1))", "illegal_option")
        client.expect_error("(set (port same))", "illegal_option")


@BOOK.rule("**Extras** follow the ball, in this order")
def extras_follow_the_ball(probe: Probe) -> None:
    with probe.client() as client:
        client.open_2(f"(extra {' '.join(reversed([*EXTRAS]))})")
        extras = read(client.view())[7]
        if "nopose" in extras:
            raise Skipped("the camera does not see the robot")
        names = re.findall(r"\(\((\w+)\)", extras)
        if names != list(EXTRAS):
            raise Broken(f"{', '.join(EXTRAS)} expected behind the ball; {', '.join(names) or 'nothing'} came")


@BOOK.rule("**Ping** is answered with `(pong)` and your number.")
def a_ping_is_answered(probe: Probe) -> None:
    with probe.client() as client:
        client.open_2()
        client.expect("(ping 7)", r"\(pong 7\)")
        client.expect("(ping)", r"\(pong\)")


@BOOK.rule("when it arrived and when the answer was sent, in nanoseconds of the clock that Time uses")
def the_clock_is_told(probe: Probe) -> None:
    with probe.client() as client:
        clock_ns = facts_of(client.open_2()).clock_ns
        before = clock_ns
        for number, t1_ns in ((1, -5), (2, 123456789012345678)):
            answer = client.expect(f"(sync {number} {t1_ns})", rf"\(sync {number} {t1_ns} [0-9]+ [0-9]+\)")
            t2_ns, t3_ns = map(int, answer.text[1:-1].split()[3:])
            if not before - 1_000_000 <= t2_ns <= t3_ns:
                raise Broken(f"T2 after {before} ns and T3 not before T2 expected; {t2_ns} and {t3_ns} came")
            before = t3_ns


@BOOK.rule("With version 2 a new client on the same computer takes over at once")
def a_newer_client_takes_over_and_the_older_is_told(probe: Probe) -> None:
    with probe.client() as older, probe.client() as newer:
        older.open_2()
        newer.open_2()
        told = older.answer()
        older.served_from = 0
        if told is None or told.text != "(error replaced)":
            raise Broken(f"(error replaced) expected for the older client; {told.text if told else 'nothing'} came")
