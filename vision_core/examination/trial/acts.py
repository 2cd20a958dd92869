"""The acts of a trial with a session: what the server does, and what it finds."""

from collections.abc import Iterator

from vision_core.clock import seconds_between
from vision_core.examination.findings import Finding, bad, doubtful, good
from vision_core.examination.trial.hearing import commands_of, inits_of, is_of_a_server, left, shown
from vision_core.examination.trial.server import LEASE_S, TrialServer
from vision_core.examination.trial.weather import CUT, FAIR, FOUL
from vision_core.models.mirror import Mirror
from vision_core.protocol.messages import MirrorQuery, Ping

FAIR_S, FOUL_S, UNSEEN_S, CUT_S, MIRROR_S = 1.5, 4.0, 3.0, 2.0, 2.5
PING_S = 1.0
MOST_INITS = 8
"""While views come, in FOUL_S and FAIR_S: a client may keep its short lease by init."""
GAP_S = 0.05
"""Between two malformed messages."""
NEW_MIRROR = Mirror(3.9, 0.0123, 88000.0)
MALFORMED = (
    b"",
    b"\0" * 64,
    b"\xff" * 1400,
    b"(" * 1400,
    b"(see",
    b"(see 99999.000 ((edge) w2cw",
    b"(see 99999.000 ((edge) w2c))",
    b"(see 99999.000 ((edge) w2c) ((ball) 61 121",
    b"(see nan ((edge) w2c) ((ball) 61 121 3))",
    b"(see 99999.000 ((edge) ) ((ball) x y z))",
    b"(init",
    b"(init blue)",
    b"(mirror nan 1 1)",
    b"(hear 1.000)",
    b"(challenge)",
    b"(sync 1 2)",
    b"(later (nested 1) words)",
    b"(warning of_a_later_version)",
    b"(hear 1.000 commentator goal)",
    b"(ok nothing)",
    b"(pong 99)",
)


def losses(server: TrialServer) -> Iterator[Finding]:
    """A third of the datagrams is lost, others come twice, late, and in another order."""
    start = server.clock.now()
    server.way.weather = FOUL
    server.play(FOUL_S)
    server.way.weather = FAIR
    server.play(FAIR_S)
    if why := left(server, start):
        yield bad("losses", f"it went away when datagrams were lost, came twice or in another order: {why}")
        return
    count = len(inits_of(server.since(start)))
    if count > MOST_INITS:
        yield doubtful("losses", f"it sent init {count} times while views came: only silence is a reason")
        return
    yield good("losses", "it goes on when datagrams are lost, come twice or in another order")


def silences(server: TrialServer) -> Iterator[Finding]:
    """The camera does not see the robot for some seconds; then the network is cut."""
    start = server.clock.now()
    server.sees_robot = False
    server.play(UNSEEN_S)
    server.sees_robot = True
    server.play(FAIR_S)
    if why := left(server, start):
        yield bad("unseen", f"it went away when the camera did not see its robot for {UNSEEN_S:g} s: {why}")
        return
    yield good("unseen", "it waits while the camera does not see its robot")
    cut = server.clock.now()
    server.way.weather, server.is_deaf = CUT, True
    server.play(CUT_S)
    server.way.weather, server.is_deaf = FAIR, False
    server.play(FAIR_S)
    if why := left(server, cut):
        yield bad("silence", f"it went away after {CUT_S:g} s without a datagram: {why}")
    else:
        yield good("silence", f"it waits through {CUT_S:g} s without a datagram")


def malformed(server: TrialServer) -> Iterator[Finding]:
    """Messages that are cut off, empty, or of a later version."""
    start = server.clock.now()
    for data in MALFORMED:
        server.say(data)
        server.play(GAP_S)
        if why := left(server, start):
            yield bad("malformed", f"it went away after {shown(data) or 'an empty datagram'}: {why}")
            return
    server.play(FAIR_S)
    answered = [one.data for one in server.since(start) if is_of_a_server(one.data)]
    if answered:
        yield bad("malformed", f"it answers messages of a server, with {shown(answered[0])}: they must not be answered")
    elif why := left(server, start):
        yield bad("malformed", f"it went away after malformed messages: {why}")
    else:
        yield good("malformed", f"it passes over {len(MALFORMED)} messages that are malformed or of a later version")


def mirror(server: TrialServer) -> Iterator[Finding]:
    """The operator changes the mirror."""
    session, start = server.session, server.clock.now()
    if session is None:
        return
    server.change_mirror(NEW_MIRROR)
    server.play(MIRROR_S)
    if why := left(server, start):
        yield bad("mirror", f"it went away when the mirror changed: {why}")
    elif session.version > 1:
        yield good(
            "mirror",
            "it goes on when it is told another mirror, (hear Time mirror A B C); whether it uses it cannot be seen",
        )
    elif any(isinstance(command, MirrorQuery) for one in server.since(start) for command in commands_of(one)):
        yield good("mirror", "it asks for the mirror again and again, so it learns of the change")
    else:
        said = "it does not ask for the mirror while it is connected; who needs millimetres asks once a second"
        yield doubtful("mirror", said)


def ping(server: TrialServer) -> Iterator[Finding]:
    """Version 2: the server asks whether the client lives; and the lease."""
    session, start = server.session, server.clock.now()
    if session is None or session.version == 1:
        return
    server.say(b"(ping 7)")
    echoed = server.play(PING_S, lambda: any(Ping(7) in commands_of(one) for one in server.since(start)))
    if echoed:
        yield good("ping", "it sends (ping 7) back")
    else:
        yield bad("ping", "it does not send (ping 7) back: another client on its computer would get its robot")
    lease_from = server.clock.now()
    ended = server.play(1.5 * LEASE_S, lambda: server.session is not session)
    if not ended:
        yield good("lease", f"it keeps its session of (lease {LEASE_S:g})")
    else:
        silent_s = seconds_between(lease_from, server.clock.now())
        said = f"it sent nothing for {silent_s:.1f} s, so its session of (lease {LEASE_S:g}) ended"
        yield bad("lease", f"{said}: a (ping) now and then keeps it")
