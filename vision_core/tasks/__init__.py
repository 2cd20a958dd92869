"""The glue: binds stages to one another. ``table`` is read first: it lists every task, what releases it, what it reads
and what it writes.

Files, outside-in: ``table``; ``process`` (the main module of every process, which runs its tasks by the executive);
the tasks, each with ``start(handle)``: ``source`` and ``capture``, ``perceive``, ``serve``, ``obstacles``,
``boundary``, ``lines``, ``exposure``, ``colors``, ``diagnose``; ``images`` (copies to look at) and ``watching`` (what
those share that watch over the camera). ``compile`` runs once, before them, over ``warm_up`` (every kernel used once);
``spare`` has done all that and waits to take a place; ``preflight``: can the tasks work with the settings?

Several stages in one compiled call, without processes of their own (benchmarks and ``stills`` use them too):
``perception`` and ``messages``, with ``see_text`` (the datagrams) and ``diagnosis`` (why nothing is seen, in words).

Behind commands of ``pslv``: ``stills`` and ``overlay`` (pictures from files, and what was seen in them drawn),
``evaluate`` over ``truth_files`` and ``matching`` (how good it was), ``pattern_sheets`` and ``pattern_colors`` (markers
to print, and whether a venue tells their colors apart).
"""
