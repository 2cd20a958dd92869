"""The log of the web process: bounded, and it never waits for whoever reads it.

A stranger's bad request may make a line, so lines are limited in number and length. stderr may be a pipe that nobody
reads: a line that would have to wait is dropped.
"""

import logging
import os
import select
import time

LINES, PERIOD_S = 20, 10.0
MAX_BYTES = 4000
"""A pipe that can be written takes so much at once (PIPE_BUF)."""
STDERR = 2


def write_line(text: str, descriptor: int = STDERR) -> bool:
    """Write a line, or drop it where writing would have to wait, or fails: False."""
    line = text.encode("utf-8", "replace")[:MAX_BYTES] + b"\n"
    ready = select.poll()
    try:
        ready.register(descriptor, select.POLLOUT)
        if not any(event & select.POLLOUT for _, event in ready.poll(0)):
            return False
        os.write(descriptor, line)
    except (OSError, ValueError):
        return False
    return True


class BoundedHandler(logging.Handler):
    """Writes LINES in PERIOD_S at most, and says how many it left out."""

    def __init__(self, descriptor: int = STDERR) -> None:
        super().__init__()
        self._descriptor = descriptor
        self._began_s = time.monotonic()
        self._written = self._left_out = 0

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, or drop it."""
        now = time.monotonic()
        if now - self._began_s >= PERIOD_S:
            if self._left_out:
                more = f"{self._left_out} more lines in {now - self._began_s:.0f} s were left out"
                write_line(more, self._descriptor)
            self._began_s, self._written, self._left_out = now, 0, 0
        if self._written >= LINES or not write_line(self.format(record), self._descriptor):
            self._left_out += 1
        else:
            self._written += 1
