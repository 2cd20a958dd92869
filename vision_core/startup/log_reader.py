"""Process: prints what the other processes of the service print.

Their standard error is a socket at which no writer waits: what does not fit into it is lost. So whoever does not read
the service's own standard error stops none of them. This process may be stopped by it, and nothing waits for this one.
Each process has MAX_LINES in PERIOD_S, so that nobody who makes a process complain can fill a disk.
"""

import os
import select
import socket
import struct
import sys
from dataclasses import dataclass

from vision_core.clock import Instant, MonotonicClock, seconds_between
from vision_core.scheduling.attachment import Attachment, attach

SOCKET = "log"
"""Name of the socket from which this process reads."""
MAX_LINES, PERIOD_S = 200, 10.0
MAX_LINE = 4000
"""A pipe that can be written takes so much at once [bytes]; a longer line is printed in pieces."""
TURN_S = 0.1
LAST_WORDS_S = 0.3
"""For what processes print while they stop."""
_CREDENTIALS = struct.Struct("3i")
"""Process, user and group of a writer."""


@dataclass(slots=True)
class _Writer:
    """A process that prints."""

    since: Instant
    rest: bytes = b""
    """What it has printed of a line that is not complete."""
    lines: int = 0
    """Printed since this period began."""
    left_out: int = 0


class LogReader:
    """Prints whole lines, for each process as many as it may."""

    def __init__(self, source: socket.socket, descriptor: int) -> None:
        """source: a stream socket at which every process prints; descriptor: takes the lines."""
        source.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
        source.setblocking(False)
        self._source = source
        self._descriptor = descriptor
        self._writers: dict[int, _Writer] = {}

    def read(self, timeout_s: float, now: Instant) -> bool:
        """Wait for output and print it; False after the timeout."""
        for pid in [pid for pid, writer in self._writers.items() if seconds_between(writer.since, now) > PERIOD_S]:
            self._end_period(pid, now)
        if not select.select([self._source], [], [], timeout_s)[0]:
            return False
        data, ancillary, _, _ = self._source.recvmsg(MAX_LINE, socket.CMSG_SPACE(_CREDENTIALS.size))
        pid = next((_CREDENTIALS.unpack(value)[0] for _, kind, value in ancillary if kind == socket.SCM_CREDENTIALS), 0)
        writer = self._writers.setdefault(pid, _Writer(now))
        *lines, writer.rest = (writer.rest + data).split(b"\n")
        if len(writer.rest) >= MAX_LINE:
            lines, writer.rest = [*lines, writer.rest[:MAX_LINE]], writer.rest[MAX_LINE:]
        for line in lines:
            self._print(line, writer)
        return True

    def end(self) -> None:
        """Print what is left: lines without an end, and how many were left out."""
        for pid in list(self._writers):
            self._end_period(pid, Instant(0))

    def _print(self, line: bytes, writer: _Writer) -> None:
        if writer.lines < MAX_LINES and self._write(line):
            writer.lines += 1
        else:
            writer.left_out += 1

    def _end_period(self, pid: int, now: Instant) -> None:
        """Print a line that was not ended for so long, say how many were left out, and forget the process."""
        writer = self._writers.pop(pid)
        if writer.rest:
            self._print(writer.rest, writer)
        if writer.left_out and not self._write(f"{writer.left_out} more lines of process {pid} were left out".encode()):
            self._writers[pid] = _Writer(now, left_out=writer.left_out)

    def _write(self, line: bytes) -> bool:
        """False: nobody reads, so it is not printed."""
        ready = select.poll()
        ready.register(self._descriptor, select.POLLOUT)
        if not any(event & select.POLLOUT for _, event in ready.poll(0)):
            return False
        try:
            os.write(self._descriptor, line[:MAX_LINE] + b"\n")
        except OSError:  # a full disk, or a reader that has gone
            return False
        return True


def run(attachment: Attachment, reader: LogReader) -> None:
    """Read until the supervisor says stop, and then the last words of the others."""
    clock = MonotonicClock()
    while not attachment.stopping:
        now = clock.now()
        attachment.heartbeat(now)
        reader.read(TURN_S, now)
    stopped = clock.now()
    while seconds_between(stopped, clock.now()) < LAST_WORDS_S:
        reader.read(TURN_S, clock.now())
    reader.end()


def main() -> None:
    """Run as the service's process."""
    attachment = attach()
    with socket.socket(fileno=attachment.resources.sockets[SOCKET]) as source:
        run(attachment, LogReader(source, sys.stderr.fileno()))


if __name__ == "__main__":
    main()
