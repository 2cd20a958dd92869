"""Asks the supervisor to start the processes of the service anew."""

from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.store import Store


class RestartRequests:
    """The record ``restart_request``, which the web process alone writes."""

    def __init__(self, store: Store) -> None:
        self._clock = MonotonicClock()
        self._writer = store.writer(records.RESTART_REQUEST.name)

    def ask(self) -> None:
        """Ask once."""
        now = self._clock.now()
        self._writer.write(b"", now, now)
