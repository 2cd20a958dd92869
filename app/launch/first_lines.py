"""What is printed before the supervisor runs: the record ``log`` begins with it."""

import time
from collections.abc import Callable

from vision_core.rtdb.log_record import LOG
from vision_core.startup.log_book import LogBook, harmless

PROCESS = "supervisor"
"""Name of the process that prints them, as soon as it is one."""


class FirstLines:
    """Prints lines, and keeps them."""

    def __init__(self, print_line: Callable[[str], None]) -> None:
        self._print_line = print_line
        self._book = LogBook()

    def say(self, line: str) -> None:
        """Print a line that holds no secret."""
        self._print_line(line)
        self._book.add(PROCESS, harmless(line.encode()), time.time())

    def record(self) -> bytes:
        """First value of the record ``log``."""
        return LOG.encode(self._book.record())
