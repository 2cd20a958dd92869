"""Rules beyond views: monitors, and driving the robots of a simulated venue."""

import re
import time

from vision_core.examination.conformance.opening import MODE
from vision_core.examination.conformance.probe import Broken, Client, Probe, Skipped, shown
from vision_core.examination.conformance.rule import RuleBook
from vision_core.examination.conformance.version_2 import CHALLENGE
from vision_core.protocol.answers import decode_message

BOOK = RuleBook()
SHOW_S = 2.0
OLDER = "(error unknown_command)"


def next_show(client: Client) -> str:
    """What a monitor is shown next. Raises Broken."""
    end = time.monotonic() + SHOW_S
    while (left_s := end - time.monotonic()) > 0.0:
        answer = client.answer(left_s)
        if answer is not None and answer.text.startswith("(show "):
            return answer.text
    raise Broken(f"(show Time ...) within {SHOW_S:g} s expected; none came")


@BOOK.rule("asks with `(dispinit)`, SoccerServer's word, and sends it again with the cookie that it is given.")
def a_monitor_is_shown_the_field(probe: Probe) -> None:
    with probe.client() as client:
        challenge = client.ask("(dispinit)").text
        if challenge in (OLDER, "(error not_admitted)", "(error wrong_key)"):
            raise Skipped(f"the server shows the field to nobody without a key, or to nobody: {challenge}")
        if not re.fullmatch(CHALLENGE, challenge):
            raise Broken(f"{CHALLENGE} expected after (dispinit); {shown(challenge)} came")
        client.expect(f"(dispinit (cookie {challenge[11:-1]}))", rf"\(dispinit {MODE}( \(.*\))?\)")
        show = next_show(client)
        if decode_message(show.encode("latin-1")) is None:
            raise Broken(f"(show Time and what is on the field) expected; {shown(show)} came")
        client.send("(bye)")
        if client.quiet_after_bye() is not None:
            raise Broken("nothing after (bye) expected; the field is shown on")


@BOOK.rule("**A command that is taken is not answered**, and it holds until the next one.")
def a_drive_is_refused_by_name_or_not_answered(probe: Probe) -> None:
    with probe.client() as client:
        told = client.open_2().text
        if "(drive " in told:
            client.expect_silence("(drive 0 0 0)")
            client.expect_error("(drive 9999 0 0)", "illegal_drive")
            client.expect_error("(drive nan 0 0)", "illegal_form")
            return
        answer = client.ask("(drive 0 0 0)").text
        if answer == OLDER:
            raise Skipped("the server knows no (drive ...)")
        if answer != "(error no_drive)":
            raise Broken(f"(error no_drive) expected, as init told no pair drive; {shown(answer)} came")
