"""The record ``log``: what the processes of the service printed. It imports little, so that its writer starts soon."""

from dataclasses import dataclass
from enum import StrEnum

from vision_core.rtdb.items import packed

MAX_LOG = 65536
"""Size of the record [bytes]."""


class LogLevel(StrEnum):
    """How bad it is, the worst first."""

    ERROR = "error"
    """Something does not work."""
    WARNING = "warning"
    """Something works worse than it should."""
    INFO = "info"

    @property
    def and_worse(self) -> "frozenset[LogLevel]":
        """This level and all that are worse."""
        levels = list(LogLevel)
        return frozenset(levels[: levels.index(self) + 1])


@dataclass(frozen=True, slots=True)
class LogLine:
    """A line that a process printed."""

    number: int
    """Counts the lines since the start of the service."""
    at: float
    """When it was printed, the last time if it was repeated [s since 1970]."""
    level: LogLevel
    process: str
    """Name of the process; "process 4711" for one that is not of the service."""
    text: str
    """It can be shown as it is: it has no control characters."""
    times: int = 1
    """How often in a row it was printed."""


@dataclass(frozen=True, slots=True)
class ServiceLog:
    """The newest lines, the newest last."""

    lines: tuple[LogLine, ...]
    left_out: int
    """Lines that are missing because a process printed more than its share."""
    older: int
    """Lines that made room for newer ones."""


LOG = packed("log", ServiceLog, MAX_LOG, 0.0)
