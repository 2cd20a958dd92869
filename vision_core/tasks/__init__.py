"""The glue: binds stages to records. ``table`` is read first: it lists every process, what releases it,
what it reads and what it writes.

Files, outside-in: ``table``; the tasks ``capture``, ``perceive``, ``serve`` (each the main module of one
process) and ``compile`` (runs once, before them); ``perception`` and ``serving`` (several stages in a row,
without processes or clocks of their own, as the tests use them); ``gauge`` (how a task does).
"""
