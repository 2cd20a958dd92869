"""The only server sockets. ``udp`` makes them and knows no protocol; ``batch`` sends one
frame's datagrams from compiled code; ``server`` joins them to ``Sessions``. ``control`` is no server: it asks a
running service for its database, for ``pslv top`` and benchmarks.

Two ports. Clients send ``init`` to the main port; everything else goes through the session port, where
each session has a socket of its own, bound to our address that the init came to and connected to its
client. So the kernel routes each client to its own socket, drops strangers' datagrams there, and reports
when a client's machine says that nobody listens. An unconnected socket on the session port catches the
rest. A session that must answer from the main port has its connected socket there.

Both ports are taken exclusively, then opened for sharing among our own: ``SO_REUSEADDR`` is set after
``bind``, so a second server meets "address already in use", while the sockets of sessions may join.
"""
