"""The executive: runs tasks at their rates and priorities, and measures them (CAMBADA paper, section 4).

Theory of operation. A task is a function that is called once per release: when the record that triggers it was
written, or on an absolute grid of its period and offset. Every process of the service runs one task or a few of
them, highest priority first, in one thread; the kernel's SCHED_FIFO does the rest: a task of higher priority preempts
whatever runs. A release that has passed is skipped and counted, never caught up. Each task can be switched off,
slowed and given another priority while it runs: the record ``proposed_settings`` says what is wanted, ``task/<name>``
what is so.

Rules: what costs time (imports, compiled code, memory) happens before a process asks for real-time priority; what
it is refused, it says. The executive measures, the tasks do not.

Files, outside-in: ``executive`` (the loop of a process), ``handle`` (what a task is given), ``releases`` (when a task
is due), ``metrics`` (how it does), ``realtime`` (what is asked of the kernel), ``selftest`` (what the machine can do),
``checks`` (is a table of tasks sound?), ``task`` (one line of it).
"""
