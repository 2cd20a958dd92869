"""Runs work in a process of its own, at a low priority, so that the loop of the page never waits for it.

``BackgroundJob`` has one job at a time, which says how far it is and can be cancelled. ``ask`` waits for a short one,
in a thread of the caller.
"""

import os
import subprocess
import sys
import threading
from collections.abc import Callable
from enum import StrEnum
from http import HTTPStatus
from typing import IO

from app.web.problems import RequestRefused
from vision_core.errors import PslvError
from vision_core.types.job_step import JobStep

NO_RESULT = "its process ended without a result"
LONG, SHORT = 10, 5
"""Niceness of long jobs, and of those for which somebody waits."""
PATIENCE_S = 60.0
"""For a short job: a loaded machine starts a process slowly."""


class JobState(StrEnum):
    """What became of the newest job."""

    NONE = "none"
    RUNNING = "running"
    DONE = "done"
    """There is a result, accepted or refused with reasons."""
    FAILED = "failed"
    """The input could not be used, or the process ended."""
    CANCELLED = "cancelled"


class BackgroundJob:
    """The newest job of a kind. Threads may share it."""

    def __init__(self, what: str) -> None:
        """what: what messages call a job, "a calibration"."""
        self._what = what
        self._lock = threading.RLock()
        self._is_busy = False
        self._process: subprocess.Popen[bytes] | None = None
        self.state = JobState.NONE
        self.step = JobStep("", 0.0)
        """The newest; with the result when the job is done."""

    def forget(self) -> None:
        """Forget the newest job. Raises RequestRefused while it runs."""
        with self._lock:
            self.check_idle()
            self.state, self.step = JobState.NONE, JobStep("", 0.0)

    def start(self, module: str, data: bytes, then: Callable[[JobStep], None] | None = None) -> None:
        """Begin. module: run as a program; data: its standard input; then: is told the last step of a job that is done.

        Raises RequestRefused while another job runs.
        """
        with self._lock:
            self.check_idle()
            self._is_busy, self.state, self.step = True, JobState.RUNNING, JobStep("starting", 0.0)
        # The process ends with the thread that starts it, so that is one which follows it to its end.
        threading.Thread(target=self._run, args=(module, data, then), daemon=True).start()

    def cancel(self) -> None:
        """End the job that runs, if one does."""
        with self._lock:
            if self._is_busy:
                self.state = JobState.CANCELLED
                if self._process is not None:
                    self._process.kill()

    def check_idle(self) -> None:
        """Raise RequestRefused while a job runs."""
        if self._is_busy:
            accepted = "wait for it, or cancel it"
            raise RequestRefused(HTTPStatus.CONFLICT, self._what, found="one is under way", accepted=accepted)

    def _run(self, module: str, data: bytes, then: Callable[[JobStep], None] | None) -> None:
        """Start the process, take note of its lines until it ends, and of what became of it."""
        step = self.step
        try:
            step = self._followed(module, data)
            with self._lock:
                if then is not None and step.result is not None and self.state is JobState.RUNNING:
                    then(step)
        except (OSError, PslvError) as error:
            step = JobStep(step.what, step.share, error=str(error))
        with self._lock:
            self._process, self._is_busy = None, False
            if self.state is JobState.CANCELLED:
                return
            self.state = JobState.FAILED if step.error or step.result is None else JobState.DONE
            if self.state is JobState.FAILED:
                self.step = JobStep(step.what, step.share, error=step.error or NO_RESULT)

    def _followed(self, module: str, data: bytes) -> JobStep:
        """The last step of the job. Raises OSError when its process cannot be started."""
        with _readable(data) as source, self._lock:
            if self.state is JobState.CANCELLED:
                return self.step
            process = subprocess.Popen(_command(module, LONG), stdin=source, stdout=subprocess.PIPE, process_group=0)
            self._process = process
        assert process.stdout is not None
        step = self.step
        try:
            for line in process.stdout:
                self.step = step = JobStep.decode(line)
        except ValueError:  # no line of a job
            process.kill()
            step = JobStep(step.what, step.share)
        process.wait()
        process.stdout.close()
        return step


def ask(module: str, data: bytes, what: str) -> JobStep:
    """The last step of a short job. Raises RequestRefused when it takes too long or ends without a result.

    module: run as a program; data: its standard input; what: what messages call it.
    """
    try:
        done = subprocess.run(
            _command(module, SHORT), input=data, stdout=subprocess.PIPE, check=False, timeout=PATIENCE_S
        )
        *_, last = done.stdout.splitlines()
        step = JobStep.decode(last)
    except subprocess.TimeoutExpired:
        found = f"no answer within {PATIENCE_S:g} s"
        raise RequestRefused(HTTPStatus.SERVICE_UNAVAILABLE, what, found=found, accepted="another try") from None
    except ValueError:  # no line, or half of one
        raise RequestRefused(
            HTTPStatus.UNPROCESSABLE_ENTITY, what, found=NO_RESULT, accepted="input that does not end it"
        ) from None
    return step


def _command(module: str, niceness: int) -> tuple[str, ...]:
    return "nice", "-n", str(niceness), sys.executable, "-m", module


def _readable(data: bytes) -> IO[bytes]:
    """A file in memory that is read from its beginning."""
    file = os.fdopen(os.memfd_create("pslv-job"), "w+b")
    file.write(data)
    file.seek(0)
    return file
