"""The server's sockets; no other package of the core opens any.

``udp`` opens UDP sockets and knows no protocol. ``delivery`` sends a frame's datagrams from compiled code, in the order
of ``sending_order``; ``fairness`` counts who had which place and lag. ``server`` joins both to the ``Sessions`` of the
protocol. ``control`` is the other side of a service's control socket: it asks a running service for its database, for
``pslv top`` and benchmarks. ``unix_peers`` names the process at the other end of a Unix socket.

Two ports. Clients send ``init`` to the main port; everything else goes through the session port. There each session has
a socket of its own, bound to our address that the init came to and connected to its client. So the kernel gives each
client's datagrams to the client's own socket, drops those of other senders there, and reports when a client's computer
has closed its port. An unconnected socket on the session port receives the rest. A session that must answer from the
main port has its connected socket there.

Both ports are bound exclusively. ``SO_REUSEADDR`` is set on our own sockets only while one of them is bound for a
session. So every other program gets "address already in use": it can neither serve beside us nor take our clients.
"""
