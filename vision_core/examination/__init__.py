"""For teams and for whoever writes a client or a server: does it do what docs/protocol.md says? NumPy alone.

    pslv check HOST              before a match: does this computer get its robot's views, how fast, how late, how many?
    pslv conformance HOST        another server, as a black box: one rule of the page after the other
    pslv check-client            a client, by a server that loses, delays, repeats and restarts

Each gives findings: a name, a grade, and a sentence for people. The exit status is that of the worst: 0 good,
1 doubtful, 2 bad.

Files: ``findings``, ``before_match`` and ``measures`` (check), ``__main__`` (the commands).
"""
