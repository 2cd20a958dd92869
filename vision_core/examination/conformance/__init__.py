"""``pslv conformance``: a server as a black box, from the wire only.

Each rule is a function that plays a client, and the sentence of docs/protocol.md that it holds the server to. It opens
its own sockets, and keeps what it sent and what came back for whoever mends the server. The server must admit this
computer, and nobody else may play the two robots that are used.

Files: ``examine`` (runs the rules), ``rule``, ``probe`` (the sockets), and the rules: ``opening``, ``ports``,
``views``, ``commands``, ``version_2``, ``beyond`` (monitors and driving).
"""
