"""The executive: runs tasks at their rates and priorities, and measures them (CAMBADA paper, section 4).

Theory of operation. A task is a function that is called once per release: when the record that triggers it was written,
or on an absolute grid of its period and offset. Every process of the service runs one task or a few of them, highest
priority first, in one thread; the kernel's SCHED_FIFO does the rest: a task of higher priority preempts whatever runs.
A task that another one of its process releases runs next. A release that has passed is skipped and counted, never
caught up. Each task can be switched off, slowed and given another priority while it runs: the record ``live_settings``
has the overrides, ``task/<name>`` the times in effect.

Rules: whatever takes time (imports, compiled code, memory) happens before a process asks for real-time priority; every
refusal of the kernel is reported. The executive measures the tasks; they do not measure themselves.

Files, outside-in: ``executive`` (the loop of a process), ``running`` (its tasks), ``handle`` (what a task is given),
``releases`` (when a task is due, and what a run reports), ``rehearser`` and ``rhythm`` (when a task runs for nothing,
so that the next release finds warm caches), ``latest_image`` and ``watching`` (for tasks that look at images),
``metrics`` (measures a task), ``realtime`` (what is asked of the kernel), ``attachment`` (what a process gets from the
supervisor), ``selftest`` (how well the machine keeps time), ``checks`` (is a table of tasks sound?). A line of the
table is ``rtdb.task.Task``.
"""
