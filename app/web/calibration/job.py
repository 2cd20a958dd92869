"""Calibrates the camera in a process of its own, one at a time; says how far it is, and keeps the result."""

from http import HTTPStatus

import msgspec

from app.web.background import BackgroundJob, JobState
from app.web.blackboard import Picture
from app.web.problems import RequestRefused
from vision_core.calibration.job import CalibrationJob
from vision_core.calibration.result import Calibration
from vision_core.startup import CALIBRATE
from vision_core.types.job_step import JobStep


class CameraCalibration:
    """The picture that is calibrated by, and the newest job. Threads may share it."""

    def __init__(self) -> None:
        self._job = BackgroundJob("a calibration")
        self.picture: Picture | None = None

    @property
    def state(self) -> JobState:
        """What became of the newest job."""
        return self._job.state

    @property
    def step(self) -> JobStep:
        """The newest step; with the result when the job is done."""
        return self._job.step

    @property
    def result(self) -> Calibration | None:
        """Of the newest job, when it is done."""
        return self.step.found(Calibration) if self.state is JobState.DONE else None

    def take(self, picture: Picture) -> None:
        """Calibrate by this picture from now on. Raises RequestRefused while a job runs."""
        self._job.forget()
        self.picture = picture

    def start(self, job: CalibrationJob) -> None:
        """Begin. Raises RequestRefused while another job runs, and without a picture."""
        self._job.check_idle()
        if self.picture is None:
            raise RequestRefused(
                HTTPStatus.CONFLICT, "a calibration", found="no picture", accepted="take a picture first"
            )
        self._job.start(CALIBRATE, msgspec.json.encode(job) + b"\n" + self.picture.pixels.tobytes())

    def cancel(self) -> None:
        """End the job that runs, if one does."""
        self._job.cancel()
