"""The supervisor: a small process that starts all others and outlives them.

Theory of operation. ``pslv serve`` lays out a plan (``plan``), and this package carries it out: it makes the
shared memory and the events, takes the sockets that were opened for it, starts one process per line of the task
table and hands each what it needs. Then it waits: for the end of a child (a pidfd tells at once), for a beat that
stays away, for a request, for a signal. A child that ends without having been asked is replaced, at once when it
has lived for a while and with a growing delay when it falls again and again; five ends within a minute disable it,
and that is said. Since memory and sockets belong to the supervisor, the others notice nothing but a silence. When
the supervisor itself is killed, the kernel kills its children, and the memory goes with them.

Starting Python with all that a child needs takes seconds. So there are warm spares: processes that have loaded
everything, and become whichever child is missing when they are told which; until that works they go before ordinary
work. A new spare is made when all is quiet.

The supervisor itself only waits, so it may ask for the highest real-time priority: load delays no restart. When it was
delayed all the same, the machine stood still, and a child's silence is counted from then on only. Nor does a child
hang that only waits for a processor.

Rules: standard library only; it never decodes what the tasks write, and never imports a stage.

Files, outside-in: ``service`` (the loop), ``control`` (the socket for requests), ``spares`` (the warm ones),
``child`` (one process), ``vitals`` (is it stuck or starved?), ``priorities`` (who goes first),
``plan`` (what to start).
"""
