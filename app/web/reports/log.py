"""What the processes of the service have printed."""

from app.web.reports.base import Report
from vision_core.rtdb.log_record import LogLevel, ServiceLog


class LogLineReport(Report):
    """A line that a process printed."""

    number: int
    """Counts the lines since the start of the service."""
    at: float
    """When it was printed, the last time if it was repeated [s since 1970]."""
    level: LogLevel
    """error: something does not work; warning: it works worse than it should; info: any other."""
    process: str
    text: str
    """Without control characters, 500 characters at most."""
    times: int
    """How often in a row it was printed."""


class LogReport(Report):
    """The newest lines, the newest last."""

    lines: list[LogLineReport]
    left_out: int
    """Lines that are missing because a process printed more than its share."""
    older: int
    """Lines that made room for newer ones."""


def log_from(log: ServiceLog, level: LogLevel = LogLevel.INFO, process: str = "") -> LogReport:
    """The lines of a level and of worse ones, of one process; process: empty for all."""
    lines = [
        LogLineReport(**{key: getattr(line, key) for key in LogLineReport.model_fields})
        for line in log.lines
        if line.level in level.and_worse and process in ("", line.process)
    ]
    return LogReport(lines=lines, left_out=log.left_out, older=log.older)
