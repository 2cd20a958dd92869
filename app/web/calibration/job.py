"""Calibrates camera, lens or mirror, or finds pairs, in a process of its own; says how far it is, keeps the results."""

from enum import StrEnum
from pathlib import Path

import msgspec

from app.web.background import BackgroundJob, JobState
from app.web.calibration.pictures import CalibrationPictures, Shown
from vision_core.calibration.board.result import LensCalibration
from vision_core.calibration.job import CalibrationJob, CameraJob, FoundPairs, LensJob, MirrorJob, PairsJob
from vision_core.calibration.mirror.result import MirrorCalibration
from vision_core.calibration.result import Calibration
from vision_core.startup import CALIBRATE
from vision_core.types.job_step import JobStep


class Work(StrEnum):
    """What is calibrated."""

    NOTHING = ""
    CAMERA = "camera"
    LENS = "lens"
    MIRROR = "mirror"
    PAIRS = "pairs"


class CameraCalibration:
    """The pictures, and the newest job. Threads may share it."""

    def __init__(self, folder: Path) -> None:
        """folder: for the pictures."""
        self.pictures = CalibrationPictures(folder)
        self.work = Work.NOTHING
        """What the newest job does."""
        self.result: Calibration | None = None
        """Of the present pictures of the field."""
        self.lens: LensCalibration | None = None
        """Of the present pictures of a board."""
        self.mirror: MirrorCalibration | None = None
        """Of the newest pairs."""
        self.found: FoundPairs | None = None
        """Around the robot in the newest picture that was looked at."""
        self._job = BackgroundJob("a calibration")

    @property
    def state(self) -> JobState:
        """What became of the newest job."""
        return self._job.state

    @property
    def step(self) -> JobStep:
        """The newest step."""
        return self._job.step

    def check_idle(self) -> None:
        """Raise RequestRefused while a job runs."""
        self._job.check_idle()

    def forget(self, kind: Shown) -> None:
        """Forget what was found by other pictures of a kind. Raises RequestRefused while a job runs."""
        self._job.forget()
        if kind is Shown.FIELD:
            self.result = None
        elif kind is Shown.BOARD:
            self.lens = None

    def calibrate(self, job: CameraJob) -> None:
        """Begin with the camera. Raises RequestRefused while another job runs."""
        self._start(Work.CAMERA, job)

    def measure(self, job: LensJob) -> None:
        """Begin with the lens. Raises RequestRefused while another job runs."""
        self._start(Work.LENS, job)

    def fit(self, job: MirrorJob) -> None:
        """Begin with a mirror. Raises RequestRefused while another job runs."""
        self._start(Work.MIRROR, job)

    def look(self, job: PairsJob) -> None:
        """Begin to look around a robot. Raises RequestRefused while another job runs."""
        self._start(Work.PAIRS, job)

    def cancel(self) -> None:
        """End the job that runs, if one does."""
        self._job.cancel()

    def _start(self, work: Work, job: CalibrationJob) -> None:
        self._job.check_idle()
        self.work = work
        self._keep(None)
        self._job.start(CALIBRATE, msgspec.msgpack.encode(job), self._keep)

    def _keep(self, last: JobStep | None) -> None:
        """Take over what the newest job found; None: nothing yet."""
        if self.work is Work.CAMERA:
            self.result = last.found(Calibration) if last else None
        elif self.work is Work.LENS:
            self.lens = last.found(LensCalibration) if last else None
        elif self.work is Work.PAIRS:
            self.found = last.found(FoundPairs) if last else None
        else:
            self.mirror = last.found(MirrorCalibration) if last else None
