"""Opens a connection."""

import re
from dataclasses import replace

from vision_core.client.connection import Connection
from vision_core.clock import Clock, MonotonicClock
from vision_core.errors import ConnectionRefused
from vision_core.models.mirror import Mirror
from vision_core.protocol.messages import Init
from vision_core.protocol.options import HIGHEST_VERSION, PAPER_OPTIONS, Options
from vision_core.protocol.proofs import MAX_KEY, Proof
from vision_core.types.objects import Team

KEY_FORM = re.compile(rf"[A-Za-z0-9_-]{{1,{MAX_KEY}}}")


def connect(
    host: str,
    port: int,
    team: Team | str,
    number: int,
    *,
    options: Options = PAPER_OPTIONS,
    mirror: Mirror | None = None,
    key: str = "",
    timeout_s: float = 5.0,
    clock: Clock | None = None,
) -> Connection:
    """Ask a server for a robot's views.

    The client speaks version 2 of the protocol, whatever ``options.version`` is, and understands servers of version 1.

    mirror: of the server's field; every ``View.mm`` and ``ball_mm`` depends on it. None: the server is asked for it. A
    mirror of your own, ``options.mirror``, is used in its place: the server then renders the views through that one,
    unless the match fixes the mirror. key: the team's, if the referee has given it one: with it the computer need not
    be admitted, and a robot that another client holds is taken over.
    timeout_s: how long to wait for an answer. While the server answers that it still prepares, the wait goes on; the
    logger "vision_core.client" says so once.

    Raises ConnectionRefused when the server refuses, with its reason, or does not answer in time, or does not tell its
    mirror, or the key is none; ValueError for an unknown team.
    """
    if key and not KEY_FORM.fullmatch(key):
        accepted = f"1 to {MAX_KEY} letters, digits, - and _, as the referee's page shows it"
        raise ConnectionRefused("the team's key", found=f"a text of {len(key)} characters", accepted=accepted)
    asked = replace(options, version=HIGHEST_VERSION)
    init = Init(Team(team), number, asked, proof=Proof(key=key))
    connection = Connection(host, port, init, mirror, clock or MonotonicClock())
    try:
        connection.open(timeout_s)
    except BaseException:
        connection.close()
        raise
    return connection
