"""Views by call: a thread that gives each newest view to a function."""

import logging
import threading
from collections.abc import Callable

from vision_core.client.view import View

LOOK_S = 0.1
"""A thread that is to end waits no longer than this for a view."""

log = logging.getLogger("vision_core.client")


class ViewThread:
    """Calls a function with the newest view until it is stopped, the session ends, or the function raises."""

    def __init__(self, newest: Callable[[float], View | None], callback: Callable[[View], object]) -> None:
        """newest: waits so long [s] for a view that is newer than the last one."""
        self._newest, self._callback = newest, callback
        self._stopping = threading.Event()
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="pslv views", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    @property
    def is_current(self) -> bool:
        """Does the caller run in this thread?"""
        return threading.current_thread() is self._thread

    @property
    def runs(self) -> bool:
        """False when it has been stopped, or has ended with an error."""
        return self._thread.is_alive()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait until it ends; returns whether it has. Raises what the function, or the connection, has raised."""
        if not self.is_current:
            self._thread.join(timeout_s)
        if self._error is not None:
            raise self._error
        return not self.runs

    def stop(self) -> None:
        """End it, after the call that may be under way; the function itself may ask for it."""
        self._stopping.set()
        if not self.is_current:
            self._thread.join()

    def _run(self) -> None:
        try:
            while not self._stopping.is_set():
                view = self._newest(LOOK_S)
                if view is not None and not self._stopping.is_set():
                    self._callback(view)
        except BaseException as error:
            self._error = error
            log.exception("the thread that follows the views ends")
