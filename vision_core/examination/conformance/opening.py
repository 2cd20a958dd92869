"""Rules about init, mistakes in it, and silence."""

import re

from vision_core.examination.conformance.probe import Broken, Probe, shown
from vision_core.examination.conformance.rule import RuleBook
from vision_core.protocol.commands import MAX_COMMAND
from vision_core.protocol.messages import PLAY_MODES

BOOK = RuleBook()
MODE = f"(?:{'|'.join(sorted(PLAY_MODES))})"
MISTAKES = {
    "(init red {number})": "illegal_team",
    "(init {team} 0)": "illegal_number",
    "(init {team} 03)": "illegal_number",
    "(init {team} 17)": "illegal_number",
    "(init {team} {number} (rate 0))": "illegal_option",
    "(init {team} {number} (rate 5) (rate 6))": "illegal_option",
    "(init {team} {number} (types all))": "illegal_option",
    "(init {team} {number} (resolution 1.1))": "illegal_option",
    "(init {team} {number} (mirror 1 1 1))": "illegal_mirror",
    "(init {team} {number} (mirror nan 0.0125935 90000))": "illegal_mirror",
}


@BOOK.rule("Modes are SoccerServer's, mostly `play_on`.")
def init_is_answered_with_the_play_mode(probe: Probe) -> None:
    with probe.client() as client:
        answer = client.open()
        if not re.fullmatch(rf"\(init {probe.robot} {MODE}\)", answer.text):
            raise Broken(
                f"(init {probe.robot} mode) expected, and nothing else in version 1; {shown(answer.text)} came"
            )


@BOOK.rule("are understood too, as are any letter case, any white space, and a newline or NUL at the end.")
def other_spellings_of_init_are_understood(probe: Probe) -> None:
    team, number = probe.team, probe.number
    spellings = (
        f"(init (team {team}) (number {number}))",
        f"(init {team} (number {number}))",
        f"(INIT {team.upper()} {number})",
        f" \t( init  {team}\r\n{number} )\n",
    )
    with probe.client() as client:
        for spelling in spellings:
            client.expect(spelling, rf"\(init {probe.robot} {MODE}\)", probe.port)
            client.served_from = probe.port


@BOOK.rule("If your init ends with NUL, everything that you get does.")
def nul_is_answered_with_nul(probe: Probe) -> None:
    with probe.client() as client:
        told = [client.open(end="\0"), client.ask("(mirror)\0"), client.view()]
        if any(not one.text.endswith("\0") for one in told):
            raise Broken("NUL at the end expected; a message without it came")
    with probe.client() as client:
        told = [client.open(), client.ask("(mirror)"), client.view()]
        if any(one.text.endswith("\0") for one in told):
            raise Broken("no NUL expected, as init had none; a message with NUL came")


@BOOK.rule("Repeat the init every 0.5 to 1 s until it is answered: the same session answers again.")
def a_repeated_init_is_answered_by_the_same_session(probe: Probe) -> None:
    with probe.client() as client:
        first = client.open()
        again = client.expect(probe.init(), rf"\(init {probe.robot} {MODE}\)", probe.port)
        if again.port != first.port:
            raise Broken(f"an answer from port {first.port} expected; it came from {again.port}")


@BOOK.rule("Errors about an init are sent each time")
def mistakes_in_init_are_named_each_time(probe: Probe) -> None:
    with probe.client() as client:
        for mistake, error in MISTAKES.items():
            for _ in range(2):
                client.expect_error(mistake.format(team=probe.team, number=probe.number), error)


@BOOK.rule(
    "a datagram that does not begin with `(`, as `init blue 3`; one of more than 1024 bytes; and one that begins like"
)
def what_is_no_command_gets_no_answer(probe: Probe) -> None:
    init = probe.init()
    silent = (
        init[1:-1],
        "",
        "\0\0\0",
        init + " " * (MAX_COMMAND + 1 - len(init)),
        "(see 1.000 ((edge) w2c) ((ball) 61 121 3))",
        "(error illegal_form)",
        "(warning unknown_option)",
        "(pong)",
        "(ok set)",
        f"(init {probe.robot} play_on)",
        "(mirror 4.0187 0.0125935 90000.0)",
    )
    with probe.client() as client:
        for text in silent:
            client.expect_silence(text)


@BOOK.rule("is answered with `(error illegal_form)`, but at most once in five seconds.")
def an_illegal_form_is_named_once(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        client.expect_error("(mirror", "illegal_form")
        client.expect_silence("(mirror")


@BOOK.rule("in version 1 they are illegal")
def unknown_options_are_illegal_in_version_1(probe: Probe) -> None:
    with probe.client() as client:
        client.expect_error(probe.init("(novelty 1)"), "illegal_option")


@BOOK.rule("What begins with `(` and cannot be parsed, as `(init blue 3`, is answered with `(error illegal_form)`")
def a_datagram_of_any_bytes_does_no_harm(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        for text in (
            "(" * 1000,
            "(" * 10 + ")" * 10,
            "\xff" * 512,
            "(set (fov inf))",
            "(lag 1e999 nan inf)",
            "(ping 9" + "9" * 900 + ")",
        ):
            client.send(text)
        while client.answer(0.2) is not None:
            pass
        client.expect("(mirror)", r"\(mirror .*\)")
