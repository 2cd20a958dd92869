"""The ball: ``finder`` in the hot path, ``reasons`` for people."""
