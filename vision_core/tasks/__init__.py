"""The glue: binds stages to records. ``table`` is read first: it lists every process, what releases it,
what it reads and what it writes.

Files, outside-in: ``table``; the tasks ``capture``, ``perceive``, ``serve`` (each the main module of one
process) and ``compile`` (runs once, before them); ``perception`` and ``serving`` (several stages in a row,
without processes of their own: benchmarks and ``stills`` use them too); ``warm_up`` (every kernel used
once); ``preflight`` (can the tasks work with the settings?); ``gauge`` (how a task does).
"""
