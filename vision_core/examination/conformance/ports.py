"""Rules about ports, and about who has a robot."""

from vision_core.examination.conformance.opening import MODE
from vision_core.examination.conformance.probe import Broken, Probe
from vision_core.examination.conformance.rule import RuleBook

BOOK = RuleBook()
CLAIM_S = 3.0
"""For the server to decide who has the robot."""


@BOOK.rule("The answer `(init blue 3 play_on)` comes **from another port**, 6001.")
def answers_and_views_come_from_another_port(probe: Probe) -> None:
    with probe.client() as client:
        answer, view = client.open(), client.view()
        if answer.port == probe.port or view.port != answer.port:
            raise Broken(f"one port other than {probe.port} expected; {answer.port} answered, {view.port} sent a view")


@BOOK.rule("views come from the port that init was sent to")
def the_same_port_can_be_asked_for(probe: Probe) -> None:
    with probe.client() as client:
        answer, view = client.open("(port same)"), client.view()
        if {answer.port, view.port} != {probe.port}:
            raise Broken(f"port {probe.port} expected; {answer.port} answered, {view.port} sent a view")


@BOOK.rule("The server notices this when the same init comes three times within seconds")
def the_third_init_is_answered_from_the_main_port(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        for _ in range(2):
            answer = client.expect(probe.init(), rf"\(init {probe.robot} {MODE}\)", probe.port)
        if answer.port != probe.port:
            raise Broken(f"port {probe.port} expected after three equal inits; {answer.port} answered")


@BOOK.rule("A client that was restarted gets its robot within a second")
def a_restarted_client_gets_its_robot(probe: Probe) -> None:
    with probe.client() as crashed:
        crashed.open()
        crashed.send("(mirror)")  # it has heard the session port
        crashed.answer()
        crashed.close()
        with probe.client() as client:
            client.send(probe.init(), probe.port)
            answer = client.answer(CLAIM_S)
            if answer is None or not answer.text.startswith("(init "):
                raise Broken(f"(init {probe.robot} ...) expected; {answer.text if answer else 'nothing'} came")
            client.served_from = answer.port


@BOOK.rule("While the old program still runs, the new one gets `(error already_connected)`")
def a_program_that_runs_keeps_its_robot(probe: Probe) -> None:
    with probe.client() as owner, probe.client() as other:
        owner.open()
        owner.expect("(mirror)", r"\(mirror .*\)")
        other.send(probe.init(), probe.port)
        answer = other.answer(CLAIM_S)
        if answer is None or answer.text != "(error already_connected)":
            raise Broken(f"(error already_connected) expected; {answer.text if answer else 'nothing'} came")
        while owner.answer(0.2) is not None:
            pass  # the server has asked whether it lives
        owner.expect("(mirror)", r"\(mirror .*\)")


@BOOK.rule("One socket may have several robots, with one init each; its other commands must then name the robot")
def one_socket_may_have_two_robots(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        client.open(number=probe.other)
        client.expect_error("(mirror)", "illegal_form")
        client.expect(f"(mirror {probe.team} {probe.other})", rf"\(mirror {probe.team} {probe.other} \S+ \S+ \S+\)")
        client.send(f"(bye {probe.robot})")
        client.expect("(mirror)", r"\(mirror \S+ \S+ \S+\)")
