"""The glue: binds stages to one another. ``table`` is read first: it lists every process, what releases it,
what it reads and what it writes.

Files, outside-in: ``table``; the tasks ``capture``, ``perceive``, ``serve``, ``obstacles``, ``diagnose`` (each the main
module of one process) and ``compile`` (runs once, before them); ``perception`` and ``messages`` (several stages in one
compiled call, without processes of their own: benchmarks and ``stills`` use them too), ``see_text`` (the datagrams in
it) and ``diagnosis`` (why nothing is seen, in words); ``warm_up`` (every kernel used once); ``preflight`` (can the
tasks work with the settings?); ``gauge`` (how a task does).

Behind commands of ``pslv``: ``stills`` and ``overlay`` (pictures from files, and what was seen in them drawn),
``evaluate`` over ``truth_files`` and ``matching`` (how good it was), ``pattern_sheets`` and ``pattern_colors`` (markers
to print, and whether a venue tells their colors apart).
"""
