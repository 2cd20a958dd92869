"""The first acts of a trial: nothing answers, the server still prepares, a session is opened."""

from collections.abc import Iterator
from itertools import pairwise
from statistics import median

from vision_core.clock import Instant, seconds_between
from vision_core.examination.findings import Finding, bad, doubtful, good
from vision_core.examination.trial.hearing import commands_of, inits_of, left, shown
from vision_core.examination.trial.server import TrialServer
from vision_core.protocol.lifecycle import SessionState
from vision_core.protocol.messages import Init, InvalidCommand

DEAF_S = 2.5
FEWEST_INITS = 2
FASTEST_INIT_S = 0.2
NOT_READY_S = 3.0
"""A client asks again within this time."""
OPEN_S = 5.0
FAIR_S = 1.5


def late_answers(server: TrialServer) -> Iterator[Finding]:
    """Nothing answers at first; then the server still prepares."""
    server.is_deaf = True
    start = server.clock.now()
    server.play(DEAF_S)
    inits = inits_of(server.since(start))
    yield _on_repetition([one.at for one in inits])
    for wrong in (command for one in server.since(start) for command in commands_of(one)):
        if isinstance(wrong, InvalidCommand):
            yield bad("init", f"its init is answered with (error {wrong.error}): {shown(server.heard[-1].data)}")
            break
    if not inits:
        return
    server.is_deaf = False
    yield from _not_ready(server)


def _on_repetition(times: list[Instant]) -> Finding:
    if len(times) < FEWEST_INITS:
        said = f"{len(times)} came in {DEAF_S:g} s without an answer"
        return bad("init", f"it does not repeat its init: {said}. Datagrams get lost: every 0.5 to 1 s")
    period_s = median(seconds_between(earlier, later) for earlier, later in pairwise(times))
    if period_s < FASTEST_INIT_S:
        return bad(
            "init", f"it repeats its init every {period_s:.2f} s: every 0.5 to 1 s is enough, servers limit more"
        )
    return good("init", f"it repeats its init every {period_s:.2f} s")


def _not_ready(server: TrialServer) -> Iterator[Finding]:
    """Answer the next init with not_ready; the client asks again after about a second."""
    start, server.is_deaf = server.clock.now(), True
    server.play(OPEN_S, lambda: bool(inits_of(server.since(start))))
    asked = inits_of(server.since(start))
    if not asked:
        yield bad("not ready", "it gave up before the server was there")
        server.is_deaf = False
        return
    told_at = server.clock.now()
    server.answer(asked[-1], b"(error not_ready)")
    server.play(NOT_READY_S, lambda: bool(inits_of(server.since(told_at))))
    server.is_deaf = False
    again = inits_of(server.since(told_at))
    if not again:
        yield bad("not ready", f"it did not ask again within {NOT_READY_S:g} s of (error not_ready)")
        return
    waited_s = seconds_between(told_at, again[0].at)
    yield good("not ready", f"it asked again {waited_s:.2f} s after (error not_ready)")


def opening(server: TrialServer) -> Iterator[Finding]:
    """A session is opened, and views come."""
    start = server.clock.now()
    server.play(OPEN_S, lambda: server.session is not None)
    session = server.session
    if session is None:
        challenged = any(
            isinstance(command, Init) and command.options.version > 1 and not command.proof.cookie
            for one in server.since(start)
            for command in commands_of(one)
        )
        why = "it does not return the cookie of (challenge ...)" if challenged else "no init came that can be answered"
        yield bad("opening", f"no session within {OPEN_S:g} s: {why}")
        return
    yield good("opening", f"it plays {session.team} {session.number} and speaks version {session.version}")
    server.play(FAIR_S)
    if session.state is SessionState.SAME_PORT and not session.options.port_same:
        cause = "is its socket connected to the main port? Receive from every port, or ask for (port same)"
        yield doubtful("port", f"it does not hear the session port: {cause}")
    if why := left(server, start):
        yield bad("views", f"it went away although all was well: {why}. Run it without a limit of views")
