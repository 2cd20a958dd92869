"""The newest lines that processes printed, bounded in number, size and length; and what each line means.

A line's level follows from how it is marked. The first that fits decides:

- error: it begins with "error", "critical" or "not ready", also after a name and a colon; it is of a traceback; or it
  says that a part of the service cannot start, cannot be loaded, or stays off;
- warning: it begins with "warning", "degraded" or "ready but degraded"; or it says that something ended and is started
  again, does not answer, is refused, is damaged, or was left out;
- info: any other.

When there is no more room, the process with the most lines loses its oldest: who prints much pushes nobody else out.
"""

import re
from collections import Counter

import msgspec

from vision_core.rtdb.log_record import MAX_LOG, LogLevel, LogLine, ServiceLog

MAX_LINES = 400
MAX_TEXT = 500
"""Characters of a line; a longer one is cut and ends with CUT."""
CUT = "…"
ROOM = MAX_LOG - 128
"""For the lines [bytes]; the rest is for the numbers beside them."""
TRACEBACK = "Traceback (most recent call last)"
_MARKS = (
    (LogLevel.ERROR, r"^([\w.-]+: )?(error|critical|not ready)\b|: it stays off|cannot (start$|be loaded)"),
    (LogLevel.WARNING, r"^([\w.-]+: )?(warning|degraded|ready but degraded)\b"),
    (
        LogLevel.WARNING,
        r"does not answer|is (refused|not restarted|damaged)|left out$|: it is started again( in [\d.]+ s)?$",
    ),
)
MARKS = tuple((level, re.compile(pattern, re.IGNORECASE)) for level, pattern in _MARKS)


def harmless(printed: bytes) -> str:
    """A line as text that nothing happens to when it is shown: what cannot be seen is written as an escape."""
    text = printed.decode(errors="backslashreplace")
    return text if text.isprintable() else "".join(c if c.isprintable() else _escaped(c) for c in text)


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode()


def level_of(text: str) -> LogLevel:
    """The level of a line by itself."""
    return next((level for level, mark in MARKS if mark.search(text)), LogLevel.INFO)


class LogBook:
    """Lines are added and the oldest go."""

    def __init__(self, kept: ServiceLog | None = None) -> None:
        """kept: what a reader before this one has left."""
        log = kept or ServiceLog((), 0, 0)
        self._lines = {line.number: line for line in log.lines}
        self._sizes = {line.number: _size(line) for line in log.lines}
        self._last = max(self._lines, default=log.older)
        self._left_out, self._older = log.left_out, log.older
        self._raising: set[str] = set()
        """Processes in the middle of a traceback."""
        self.has_news = False

    def record(self) -> ServiceLog:
        """Everything that is kept; afterwards there is no news."""
        self.has_news = False
        return ServiceLog(tuple(self._lines.values()), self._left_out, self._older)

    def add(self, process: str, text: str, at: float) -> None:
        """Add a line, printed at a time [s since 1970]; the process's name is not repeated in it.

        An empty line says nothing and is not kept.
        """
        text = text.removeprefix(f"{process}: ")
        if not text.strip():
            return
        level = self._level_of(process, text)
        text = text if len(text) <= MAX_TEXT else text[: MAX_TEXT - len(CUT)] + CUT
        before = self._lines.get(self._last)
        times = before.times + 1 if before and (before.process, before.text) == (process, text) else 1
        if times == 1:
            self._last += 1
        line = LogLine(self._last, at, level, process, text, times)
        self._lines[line.number], self._sizes[line.number] = line, _size(line)
        while len(self._lines) > MAX_LINES or sum(self._sizes.values()) > ROOM:
            self._forget_one()
        self.has_news = True

    def leave_out(self) -> None:
        """Count a line that is not added, because its process printed too many."""
        self._left_out += 1
        self.has_news = True

    def _level_of(self, process: str, text: str) -> LogLevel:
        """The level of a process's next line: a traceback ends with the first line that is not indented."""
        if TRACEBACK in text:
            self._raising.add(process)
            return LogLevel.ERROR
        if process not in self._raising:
            return level_of(text)
        if not text.startswith(" "):
            self._raising.discard(process)
        return LogLevel.ERROR

    def _forget_one(self) -> None:
        (process, _), *_ = Counter(line.process for line in self._lines.values()).most_common(1)
        oldest = next(number for number, line in self._lines.items() if line.process == process)
        del self._lines[oldest], self._sizes[oldest]
        self._older += 1


def _size(line: LogLine) -> int:
    return len(msgspec.msgpack.encode(line))
