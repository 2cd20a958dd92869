"""The tasks: one file per line of ``table``, which is read first. Each has ``start(handle)`` and returns its step.

Frame path: ``source`` and ``capture``, ``perceive``, ``serve``. Watchers: ``obstacles``, ``boundary``, ``lines``,
``exposure``, ``colors``, ``diagnose``; ``overlay`` while somebody looks.
"""
