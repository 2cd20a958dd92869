"""The supervisor: a small process that starts all others and outlives them.

Theory of operation. ``pslv serve`` makes a plan (``plan``), and this package carries it out: it makes the shared memory
and the events, takes the sockets that were opened for it, starts one process per process of the task table and passes
each its resources. Then it waits for the end of a child (a pidfd reports it at once), an overdue heartbeat, a request,
or a signal. A child that ends unasked is started again: at once when it ran for a while, with a growing delay when it
crashes repeatedly. Five crashes within a minute disable it; the page, /readyz and the log report that, and ``pslv
restart NAME`` starts it again. Since memory and sockets belong to the supervisor, the other processes notice only that
its records are not written for a while. When the supervisor itself is killed, the kernel kills its children, and the
memory is released with them.

Starting Python with everything that a child needs takes seconds. So there are warm spares: processes that have loaded
everything and become the child that the supervisor names. A spare runs before ordinary processes until its first
heartbeat in the new place. A new spare is started when no other process is starting.

The supervisor only waits, so it may have the highest real-time priority: load delays no restart. When its own loop was
late all the same, the whole machine stood still, and heartbeats are expected from then on only. A process that computes
or waits for a processor is not hung: a real-time one may compute for its period, an ordinary one for half a minute.

The whole service can be restarted; its clients notice a pause of about a second. A process of its own checks that the
service would start. Then ``app.launch.service`` makes a second supervisor with the same sockets and the same clock,
whose processes load everything while the first goes on. Then the first stops, and the second begins with the sessions.

Rules: standard library only; it never decodes what the tasks write, and never imports a stage.

Files, outside-in: ``supervisor`` (the loop), ``restart`` (of the whole service), ``family`` (memory, events and
processes of a plan), ``control`` (the socket for requests), ``spares`` (warm spares), ``child`` (one process),
``lifecycle`` (its states and transitions), ``vitals`` (is it hung?), ``priorities`` (which process runs first),
``plan`` (what to start).
"""
