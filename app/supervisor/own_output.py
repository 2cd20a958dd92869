"""What the supervisor itself prints, without ever waiting, and in the same log as what its children print."""

import contextlib
import signal
import socket
import time
from collections.abc import Callable, Mapping, Sequence

from app.supervisor.child import Child
from app.supervisor.plan import LOG, OUTPUT
from vision_core.rtdb.process_state import ProcessState

LAST_PRINT_S = 0.5
"""Time that the process that prints has for what is left when all others have ended."""
MOST_LEFT = 1 << 18
"""More than the socket holds [bytes]."""
READS = (ProcessState.STARTING, ProcessState.RUNNING, ProcessState.RESTARTING)
"""States of the process that prints in which it reads what is in its socket, now or soon."""


class OwnOutput:
    """Prints through the process that prints for all; without one, and once that was given up, directly."""

    def __init__(
        self, children: Sequence[Child], sockets: Mapping[str, socket.socket], directly: Callable[[str], None]
    ) -> None:
        """directly: prints a line; it may have to wait for whoever reads it."""
        self.reader = next((child for child in children if LOG in child.plan.sockets), None)
        """The process that prints for all."""
        self._sockets = sockets
        self._directly = directly

    def say(self, line: str) -> None:
        """Print a line. One that does not fit into the socket is lost, as a line of any process is."""
        if self.reader is None or self.reader.state not in READS:
            self._directly(line)
            return
        with contextlib.suppress(BlockingIOError):
            self._sockets[OUTPUT].send(line.encode() + b"\n")

    def end(self) -> None:
        """End the process that prints, when all others have ended and it has printed what they said."""
        if self.reader is None:
            return
        self.reader.signal(signal.SIGTERM)
        self._sockets[OUTPUT].close()  # the last copy: its end tells the reader that nothing more comes
        wait_for_end([self.reader], LAST_PRINT_S)
        self.reader.stop_for_good()
        self._sockets[LOG].setblocking(False)
        with contextlib.suppress(BlockingIOError):
            for line in self._sockets[LOG].recv(MOST_LEFT).decode(errors="replace").splitlines():
                self._directly(line)
        self._sockets[LOG].close()


def wait_for_end(children: Sequence[Child], patience_s: float) -> None:
    """Wait until all have ended, or the patience has."""
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline and not all(child.process is None or child.has_ended() for child in children):
        time.sleep(0.01)
