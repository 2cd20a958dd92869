"""7. RobotView <-> datagram: the PSLV wire protocol, version 1, without sockets (``docs/protocol.md``).

Bytes, addresses and instants go in; replies and events come out. Who owns sockets is ``vision_core.net``
on the server's side and ``vision_core.client`` on the team's.

    datagram -> forms -> codec -> a Request of messages     -> Sessions -> Reply, SessionOpened, ...
    RobotView + Options + Mirror + LetterTable -> see       -> datagram

Rules. The wire never raises: decoding gives a message or None, in bounded time and without recursion,
whatever the bytes. Our own misuse raises. No reply goes to what looks like a server's own message, so
two servers cannot talk to each other for ever; no answer to an address that is not admitted is longer
than three times its request. Every table is bounded.

Files, outside in: ``messages`` (what is said), ``refusals`` (the errors), ``options`` (what a client
may ask for), ``letters`` (edge types), ``forms`` (brackets and words), ``codec`` (messages <-> bytes), ``see``
(views -> bytes), ``session`` (all sessions of a server), ``lifecycle`` (one session), ``admission`` (who may
connect), ``limits`` (how often).
"""
