"""7. RobotView <-> datagram: the PSLV wire protocol, versions 1 and 2, without sockets (``docs/protocol.md``).

Bytes, addresses and instants go in; replies and events come out. The sockets belong to ``vision_core.net`` on the
server's side and to ``vision_core.client`` on the team's side.

    datagram -> s_expressions -> commands -> a Request -> Door -> Sessions -> Reply, SessionOpened, ...
    RobotView + Options + Mirror + EdgeCodes -> see -> datagram

Rules. Decoding never raises: it gives a message or None, in bounded time and without recursion, whatever the bytes.
A mistake of our own code raises. The server does not answer what looks like a server's message, so that two servers
do not answer each other for ever. No answer to an address that is not admitted is longer than three times its
request. Every table is bounded.

Files, from the top down: ``session`` (all sessions of a server), ``door`` (who may speak, and who may have a robot),
``rules`` (what the server prescribes), ``events``, ``lifecycle`` (one session), ``admission`` (which addresses may
connect), ``proofs`` (cookies and keys), ``rate_limits``, ``encoding`` (messages -> bytes), ``commands`` and ``answers``
(bytes -> messages, of clients and of servers), ``messages`` (records), ``error_codes``, ``options`` (of init),
``words``, ``s_expressions`` (the syntax), ``edge_codes`` (letters of edge types), ``see`` (views -> bytes; the
reference for the compiled encoder).
"""
