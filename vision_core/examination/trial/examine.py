"""Runs the acts."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType

from vision_core.examination.findings import Finding, Grade, bad, worst
from vision_core.examination.trial import acts, ends, opening
from vision_core.examination.trial.server import TrialServer

Act = Callable[[TrialServer], Iterator[Finding]]
WITHOUT_SESSION: Mapping[str, Act] = MappingProxyType(
    {"late-answers": opening.late_answers, "opening": opening.opening}
)
WITH_SESSION: Mapping[str, Act] = MappingProxyType(
    {
        "losses": acts.losses,
        "silences": acts.silences,
        "malformed": acts.malformed,
        "mirror": acts.mirror,
        "ping": acts.ping,
        "restart": ends.restart,
        "replaced": ends.replaced,
        "farewell": ends.farewell,
    }
)
ACTS: Mapping[str, Act] = MappingProxyType({**WITHOUT_SESSION, **WITH_SESSION})
"""In their order."""


def examine_client(server: TrialServer, names: Sequence[str] = (), *, wait_s: float) -> Iterator[Finding]:
    """Play the acts to a client; the last finding is the verdict. names: of the acts, none: all.

    wait_s: how long to wait for a client's first datagram.
    """
    found = []
    for finding in _findings(server, names, wait_s):
        found.append(finding)
        yield finding
    grade = worst(found)
    wrong = ", ".join(dict.fromkeys(finding.name for finding in found if finding.grade == grade))
    said = ("a good client", f"it plays, but look at: {wrong}", f"to be mended: {wrong}")[grade]
    yield Finding("verdict", Grade(grade), said)


def _findings(server: TrialServer, names: Sequence[str], wait_s: float) -> Iterator[Finding]:
    server.is_deaf = True
    server.program.start()
    if not server.play(wait_s, lambda: bool(server.heard)):
        yield bad("init", f"no datagram came to port {server.port} within {wait_s:g} s")
        return
    server.is_deaf = False
    for name, act in ACTS.items():
        if (names and name not in names) or (name == "farewell" and not server.program.command):
            continue
        server.program.start()
        if name in WITH_SESSION and not server.play(opening.OPEN_S, lambda: server.session is not None):
            yield bad(name, "no session to play this act with: the client is gone, or its init is not answered")
            continue
        yield from act(server)
    yield from ends.of_all_acts(server)
