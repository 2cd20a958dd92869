"""Rules about what a client may send in its session."""

import re

from vision_core.examination.conformance.probe import QUIET_S, Broken, Probe, shown
from vision_core.examination.conformance.rule import RuleBook
from vision_core.protocol.options import mirror_from_words
from vision_core.protocol.rate_limits import COMPLAINT_PERIOD_S

BOOK = RuleBook()


@BOOK.rule("The answer is `(mirror A B C)`, from the port that your views come from")
def the_mirror_is_told(probe: Probe) -> None:
    with probe.client() as client:
        session = client.open()
        answer = client.expect("(mirror)", r"\(mirror \S+ \S+ \S+\)")
        if mirror_from_words(answer.text[1:-1].split()[1:]) is None:
            raise Broken(f"the constants of a mirror expected; {shown(answer.text)} came")
        if answer.port != session.port:
            raise Broken(f"an answer from port {session.port} expected; it came from {answer.port}")


@BOOK.rule("You may send the question in one datagram with your init, `(init blue 3)(mirror)`.")
def a_datagram_may_hold_several_forms(probe: Probe) -> None:
    with probe.client() as client:
        client.send(f"{probe.init()}(mirror)")
        told = [answer.text for answer in (client.answer(), client.answer()) if answer]
        client.served_from = probe.port
        if [text.partition(" ")[0] for text in told] != ["(init", "(mirror"]:
            raise Broken(f"(init ...) and (mirror ...) expected; {told} came")


@BOOK.rule("reports the delays that only you can measure; it gets no answer.")
def a_lag_report_gets_no_answer(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        match = re.match(r"\(see (\S+) ", client.view().text)
        client.expect_silence(f"(lag {match[1] if match else 0} 0.4 6.5)")


@BOOK.rule("the commands are those above")
def an_unknown_command_is_named(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        client.expect_error("(dash 100)", "unknown_command")


@BOOK.rule("Without a session the answer is `(error not_connected)`")
def without_a_session_there_is_no_mirror(probe: Probe) -> None:
    with probe.client() as client:
        client.send("(mirror)")
        answer = client.answer() or client.answer(COMPLAINT_PERIOD_S)  # it may have been told so a moment ago
        if answer is None:
            client.send("(mirror)")
            answer = client.answer()
        if answer is None or answer.text != "(error not_connected)":
            raise Broken(f"(error not_connected) expected; {answer.text if answer else 'nothing'} came")


@BOOK.rule("When you stop, send `(bye)` to the port that the views came from.")
def bye_ends_the_views(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        client.view()
        client.send("(bye)")
        while client.receive(QUIET_S / 3.0) is not None:
            if len(probe.exchange) > 100:
                raise Broken("no view after (bye) expected; they go on")
