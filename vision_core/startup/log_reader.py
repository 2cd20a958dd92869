"""Process: prints what the other processes of the service print, and keeps the newest lines in the record ``log``.

Their standard error is a socket at which no writer waits: what does not fit into it is lost. So whoever does not read
the service's own standard error stops none of them. This process may be stopped by it, and nothing waits for this one.
Each process has MAX_LINES in PERIOD_S, so that nobody who makes a process complain can fill a disk. A line may contain
what a stranger sent, so it is printed and kept without control characters.
"""

import os
import select
import socket
import struct
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

from vision_core.clock import Instant, MonotonicClock, seconds_between
from vision_core.rtdb.log_record import LOG
from vision_core.scheduling.attachment import Attachment, attach
from vision_core.startup.log_book import LogBook, harmless
from vision_core.startup.process_names import ProcessNames

SOCKET = "log"
"""Name of the socket from which this process reads."""
MAX_LINES, PERIOD_S = 200, 10.0
MAX_LINE = 4000
"""A pipe that can be written takes so much at once [bytes]; a longer line is printed in pieces."""
TURN_S = 0.1
PUBLISH_EVERY_S = 0.25
"""The record is written at most so often."""
LAST_WORDS_S = 2.0
"""For what processes print while they stop: longer than the supervisor waits for them."""
_CREDENTIALS = struct.Struct("3i")
"""Process, user and group of a writer."""


@dataclass(slots=True)
class _Writer:
    """A process that prints."""

    since: Instant
    rest: bytes = b""
    """What it has printed of a line that is not complete."""
    lines: int = 0
    """Kept since this period began."""
    left_out: int = 0
    """Not printed."""


class LogReader:
    """Prints and keeps whole lines, for each process as many as it may."""

    def __init__(self, source: socket.socket, descriptor: int, book: LogBook, name_of: Callable[[int], str]) -> None:
        """source: a stream socket at which every process prints; descriptor: takes the lines; name_of: a process."""
        source.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
        source.setblocking(False)
        self._source = source
        self._descriptor = descriptor
        self._book = book
        self._name_of = name_of
        self._writers: dict[int, _Writer] = {}
        self.has_ended = False
        """Nobody can print any more."""

    def read(self, timeout_s: float, now: Instant) -> bool:
        """Wait for output, print and keep it; False after the timeout, and when nobody can print any more."""
        for pid in [pid for pid, writer in self._writers.items() if seconds_between(writer.since, now) > PERIOD_S]:
            self._end_period(pid, now)
        if self.has_ended or not select.select([self._source], [], [], timeout_s)[0]:
            return False
        data, ancillary, _, _ = self._source.recvmsg(MAX_LINE, socket.CMSG_SPACE(_CREDENTIALS.size))
        if not data:
            self.has_ended = True
            return False
        pid = next((_CREDENTIALS.unpack(value)[0] for _, kind, value in ancillary if kind == socket.SCM_CREDENTIALS), 0)
        writer = self._writers.setdefault(pid, _Writer(now))
        *lines, writer.rest = (writer.rest + data).split(b"\n")
        if len(writer.rest) >= MAX_LINE:
            lines, writer.rest = [*lines, writer.rest[:MAX_LINE]], writer.rest[MAX_LINE:]
        for line in lines:
            self._take(line, pid, writer)
        return True

    def end(self) -> None:
        """Print what is left: lines without an end, and how many were left out."""
        for pid in list(self._writers):
            self._end_period(pid, Instant(0))

    def _take(self, line: bytes, pid: int, writer: _Writer) -> None:
        """Keep and print a line, if its process has not printed too many."""
        if writer.lines >= MAX_LINES:
            writer.left_out += 1
            self._book.leave_out()
            return
        writer.lines += 1
        text = harmless(line)
        self._book.add(self._name_of(pid), text, time.time())
        if not self._write(text):
            writer.left_out += 1

    def _end_period(self, pid: int, now: Instant) -> None:
        """Print a line that was not ended for so long, say how many were left out, and forget the process."""
        writer = self._writers.pop(pid)
        if writer.rest:
            self._take(writer.rest, pid, writer)
        if writer.left_out and not self._write(f"{writer.left_out} more lines of {self._name_of(pid)} were left out"):
            self._writers[pid] = _Writer(now, left_out=writer.left_out)

    def _write(self, text: str) -> bool:
        """False: nobody reads, so it is not printed."""
        ready = select.poll()
        ready.register(self._descriptor, select.POLLOUT)
        if not any(event & select.POLLOUT for _, event in ready.poll(0)):
            return False
        try:
            os.write(self._descriptor, text.encode()[:MAX_LINE] + b"\n")
        except OSError:  # a full disk, or a reader that has gone
            return False
        return True


class Publisher:
    """Writes a book into the record ``log`` when there is news, but not too often."""

    def __init__(self, book: LogBook, attachment: Attachment) -> None:
        self._book = book
        self._record = LOG.writer(attachment.store)
        self._written = Instant(0)

    def publish(self, now: Instant, *, at_once: bool = False) -> None:
        """Write the record if there is news and it is time to, or at once."""
        if self._book.has_news and (at_once or seconds_between(self._written, now) >= PUBLISH_EVERY_S):
            self._record.write(self._book.record(), now, now)
            self._written = now


def run(attachment: Attachment, reader: LogReader, publisher: Publisher) -> None:
    """Read until the supervisor says stop, and then the last words of the others, until nobody is left."""
    clock = MonotonicClock()
    stopped: Instant | None = None
    while not reader.has_ended and (stopped is None or seconds_between(stopped, clock.now()) < LAST_WORDS_S):
        now = clock.now()
        stopped = stopped or (now if attachment.stopping else None)
        attachment.heartbeat(now)
        reader.read(TURN_S, now)
        publisher.publish(clock.now())
    reader.end()
    publisher.publish(clock.now(), at_once=True)  # a restarted service goes on with it


def main() -> None:
    """Run as the service's process. It goes on with the lines that one before it has kept."""
    attachment = attach()
    kept = LOG.reader(attachment.store).read(MonotonicClock().now())
    book = LogBook(kept.value if kept else None)
    names = ProcessNames(attachment.store.reader("processes"))
    with socket.socket(fileno=attachment.resources.sockets[SOCKET]) as source:
        reader = LogReader(source, sys.stderr.fileno(), book, names.of)
        run(attachment, reader, Publisher(book, attachment))


if __name__ == "__main__":
    main()
