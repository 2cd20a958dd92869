"""Calibrates the camera in a process of its own, one at a time; says how far it is, and keeps the result."""

import os
import subprocess
import sys
import threading
from enum import StrEnum
from http import HTTPStatus
from typing import IO

import msgspec

from app.web.blackboard import Picture
from app.web.problems import RequestRefused
from vision_core.calibration.job import CalibrationJob, CalibrationStep
from vision_core.calibration.result import Calibration
from vision_core.startup import CALIBRATE

COMMAND = ("nice", "-n", "19", sys.executable, "-m", CALIBRATE)
NO_RESULT = "its process ended without a result"


class JobState(StrEnum):
    """What became of the newest job."""

    NONE = "none"
    RUNNING = "running"
    DONE = "done"
    """There is a result, accepted or refused with reasons."""
    FAILED = "failed"
    """The input could not be used, or the process ended."""
    CANCELLED = "cancelled"


class CameraCalibration:
    """The picture that is calibrated by, and the newest job. Threads may share it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self.picture: Picture | None = None
        self.state = JobState.NONE
        self.step = CalibrationStep("", 0.0)
        """The newest; with the result when the job is done."""

    @property
    def result(self) -> Calibration | None:
        """Of the newest job, when it is done."""
        return self.step.result if self.state is JobState.DONE else None

    def take(self, picture: Picture) -> None:
        """Calibrate by this picture from now on. Raises RequestRefused while a job runs."""
        with self._lock:
            self._check_idle()
            self.picture, self.state, self.step = picture, JobState.NONE, CalibrationStep("", 0.0)

    def start(self, job: CalibrationJob) -> None:
        """Begin. Raises RequestRefused while another job runs, and without a picture."""
        with self._lock:
            self._check_idle()
            if self.picture is None:
                raise RequestRefused(
                    HTTPStatus.CONFLICT, "a calibration", found="no picture", accepted="take a picture first"
                )
            with _readable(msgspec.json.encode(job) + b"\n" + self.picture.pixels.tobytes()) as source:
                process = subprocess.Popen(COMMAND, stdin=source, stdout=subprocess.PIPE, process_group=0)
            self._process, self.state = process, JobState.RUNNING
            self.step = CalibrationStep("starting", 0.0)
        threading.Thread(target=self._follow, args=(process,), daemon=True).start()

    def cancel(self) -> None:
        """End the job that runs, if one does."""
        with self._lock:
            if self._process is not None:
                self.state = JobState.CANCELLED
                self._process.kill()

    def _follow(self, process: subprocess.Popen[bytes]) -> None:
        """Take note of every line until the process ends."""
        assert process.stdout is not None
        try:
            for line in process.stdout:
                self.step = CalibrationStep.decode(line)
        except ValueError:
            process.kill()
        process.wait()
        process.stdout.close()
        with self._lock:
            self._process = None
            if self.state is JobState.CANCELLED:
                return
            self.state = JobState.DONE if self.step.result else JobState.FAILED
            if self.state is JobState.FAILED and not self.step.error:
                self.step = CalibrationStep(self.step.what, self.step.share, error=NO_RESULT)

    def _check_idle(self) -> None:
        if self._process is not None:
            raise RequestRefused(
                HTTPStatus.CONFLICT, "a calibration", found="one is under way", accepted="wait for it, or cancel it"
            )


def _readable(data: bytes) -> IO[bytes]:
    """A file in memory that is read from its beginning."""
    file = os.fdopen(os.memfd_create("pslv-calibration"), "w+b")
    file.write(data)
    file.seek(0)
    return file
