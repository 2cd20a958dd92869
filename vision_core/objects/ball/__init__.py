"""The ball: ``finder`` in the hot path, ``reasons`` and ``verdicts`` for people."""
