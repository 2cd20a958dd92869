"""The last acts of a trial: the server restarts, the robot is somebody else's, the program is stopped."""

from collections.abc import Iterator

from vision_core.clock import Instant, seconds_between
from vision_core.examination.findings import Finding, bad, doubtful, good
from vision_core.examination.trial.hearing import commands_of, inits_of
from vision_core.examination.trial.server import Heard, TrialServer
from vision_core.protocol.lifecycle import Port
from vision_core.protocol.messages import Bye

FAIR_S = 1.5
DOWN_S = 1.0
BACK_S = 10.0
"""Within this time a client has to be on again."""
SLOW_S = 5.0
REPLACED_S = 4.0
STOPPED_S = 3.0
MOST_IN_A_SECOND = 100
"""Datagrams: a server drops more unread."""


def restart(server: TrialServer) -> Iterator[Finding]:
    """The server ends and starts anew: Time begins anew, the port was closed in between."""
    seen_at = server.view_at or server.clock.now()
    server.go_down()
    server.play(DOWN_S)
    server.come_up()
    up_at = server.clock.now()

    def is_on_again() -> bool:
        return server.session is not None and (server.view_at or up_at) > up_at

    if not server.play(BACK_S, is_on_again):
        why = "it sent no init" if not inits_of(server.since(up_at)) else "its init opened no session"
        ended = server.program.status
        said = f"; its program ended (exit status {ended})" if ended is not None else ""
        yield bad("restart", f"it did not find the restarted server again within {BACK_S:g} s: {why}{said}")
        return
    back_s = seconds_between(up_at, server.view_at or up_at)
    gap_s = seconds_between(seen_at, server.view_at or up_at)
    said = f"it saw again {back_s:.2f} s after the server was back, {gap_s:.2f} s after its last view"
    yield (good if back_s <= SLOW_S else doubtful)("restart", said)


def replaced(server: TrialServer) -> Iterator[Finding]:
    """Another client has the robot."""
    server.end_session(b"replaced")
    start = server.clock.now()
    server.play(REPLACED_S)
    if inits := inits_of(server.since(start)):
        said = f"it sent init again {seconds_between(start, inits[0].at):.2f} s after (error replaced)"
        yield bad("replaced", f"{said}: so two clients take the robot from each other without end")
    else:
        yield good("replaced", "it does not ask again when a newer client has its robot")


def farewell(server: TrialServer) -> Iterator[Finding]:
    """The program is stopped by Ctrl-C."""
    server.play(BACK_S, lambda: server.session is not None)  # it may have to start again
    server.play(FAIR_S)
    start = server.clock.now()
    server.program.interrupt()
    server.play(STOPPED_S, lambda: server.program.status is not None)
    server.play(0.1)
    if not any(map(_has_bye, server.since(start))):
        said = "it says no (bye) when it is stopped by Ctrl-C"
        yield doubtful("bye", f"{said}: its robot is free only when its computer reports the closed port")
        return
    yield good("bye", "it says (bye) when it is stopped")


def of_all_acts(server: TrialServer) -> Iterator[Finding]:
    """What all datagrams together show."""
    if any(one.port is Port.MAIN and _has_bye(one) and not one.same_port for one in server.heard):
        yield doubtful("bye", "it sends (bye) to the port of init: send it to the port that the views came from")
    if (most := _most_in_a_second([one.at for one in server.heard])) > MOST_IN_A_SECOND:
        yield bad(
            "flood", f"it sent {most} datagrams within a second: servers drop more than {MOST_IN_A_SECOND} unread"
        )


def _has_bye(heard: Heard) -> bool:
    return any(isinstance(command, Bye) for command in commands_of(heard))


def _most_in_a_second(times: list[Instant]) -> int:
    """The greatest number of instants within one second."""
    first = most = 0
    for last, time in enumerate(times):
        while seconds_between(times[first], time) > 1.0:
            first += 1
        most = max(most, last - first + 1)
    return most
