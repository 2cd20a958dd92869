"""The supervisor: a small process that starts all others and outlives them.

Theory of operation. ``pslv serve`` lays out a plan (``plan``), and this package carries it out: it makes
the shared memory and the events, takes the sockets that were opened for it, starts one process per line of
the task table and hands each what it needs. Then it waits: for the end of a child (a pidfd tells at once),
for a heartbeat that stays away, for a signal. A child that ends without having been asked is started again,
at once the first time and with a growing delay after that; five ends within a minute disable it, and that is
said. Since memory and sockets belong to the supervisor, the others notice nothing but a silence. When the
supervisor itself is killed, the kernel kills its children, and the memory goes with them.

Rules: standard library only; it never decodes what the tasks write, and never imports a stage.

Files, outside-in: ``service`` (the loop), ``child`` (one process), ``plan`` (what to start).
"""
