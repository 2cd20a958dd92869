"""A restart of the whole service: asked for, checked while everything goes on, then refused or carried out."""

import os
import subprocess
from collections.abc import Callable
from typing import Any

from vision_core.rtdb.process_state import RestartState

CARRIED = ("sessions", "fairness", "fairness_ended", "selftest", "log")
"""Records whose values the service goes on with after a restart: its clients and how fairly they were served, how well
the machine keeps time, and what was printed."""
MAX_DETAIL = 400


class Restart:
    """The newest request to restart the service. A process of its own finds out whether the service would start."""

    def __init__(self, command: tuple[str, ...], log: Callable[[str], None]) -> None:
        """command: finds out whether the service would start; empty: it cannot be restarted. log: takes one line."""
        self._command = command
        self._log = log
        self._process: subprocess.Popen[bytes] | None = None
        self.state = RestartState.NONE
        self.detail = ""

    def row(self) -> dict[str, Any]:
        """As the record ``processes`` has it."""
        return {"state": self.state, "detail": self.detail[:MAX_DETAIL]}

    def request(self, who: str) -> None:
        """Find out whether the service would start, as soon as ``follow`` says that all of it runs."""
        if self.state in (RestartState.CHECKING, RestartState.RESTARTING):
            return
        self._log(f"{who} asks for a restart of the service")
        self.state, self.detail = RestartState.CHECKING, "waiting until every process runs"
        if not self._command:
            self.refuse("it was started in a way that cannot be repeated")

    def follow(self, *, is_complete: bool) -> None:
        """Begin the check, and take note of what it prints and of its end. is_complete: every process runs."""
        if self.state is not RestartState.CHECKING:
            return
        if self._process is None:
            if is_complete:
                self._begin()
            return
        assert self._process.stdout is not None
        status = self._process.poll()
        if lines := (self._process.stdout.read() or b"").decode(errors="replace").strip().splitlines():
            self.detail = lines[-1]
        if status is None:
            return
        self._process.stdout.close()
        self._process = None
        if status:
            self.refuse(self.detail)
        else:
            self.state, self.detail = RestartState.RESTARTING, "the new processes load what they need"
            self._log("the service is restarted as soon as its new processes have loaded what they need")

    def refuse(self, why: str) -> None:
        """Let the service go on as it is. why: in words."""
        self.state, self.detail = RestartState.REFUSED, why
        self._log(f"the service is not restarted, and goes on as it is: {why}")

    def _begin(self) -> None:
        try:
            self._process = subprocess.Popen(
                self._command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, process_group=0
            )
        except OSError as error:
            self.refuse(f"the check could not be started: {error.strerror}")
            return
        assert self._process.stdout is not None
        os.set_blocking(self._process.stdout.fileno(), False)
        self.detail = "reading the settings"

    def close(self) -> None:
        """End the check."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
