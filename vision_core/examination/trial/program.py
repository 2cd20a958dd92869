"""The client's process, or somebody who starts it by hand."""

import signal
import subprocess
from collections.abc import Sequence

from vision_core.errors import PslvError

STOP_S = 3.0


class Program:
    """A command that is started again when it has ended; without words, a person starts the client."""

    def __init__(self, command: Sequence[str]) -> None:
        self.command = tuple(command)
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def status(self) -> int | None:
        """Its exit status if it has ended; None: it runs, or is not ours."""
        return self._process.poll() if self._process else None

    def start(self) -> None:
        """Start it unless it runs. Raises PslvError for a command that cannot be started."""
        if not self.command or (self._process and self.status is None):
            return
        try:
            self._process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        except OSError as error:
            accepted = "a program and its words, behind --"
            raise PslvError(" ".join(self.command), found=error.strerror or str(error), accepted=accepted) from None

    def interrupt(self) -> None:
        """Ctrl-C."""
        if self._process and self.status is None:
            self._process.send_signal(signal.SIGINT)

    def stop(self) -> None:
        """End it, by force if it has to be."""
        if self._process and self.status is None:
            self._process.terminate()
            try:
                self._process.wait(STOP_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
