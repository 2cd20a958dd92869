"""Short process beside a running service: calibrates the camera by one picture.

Standard input has a ``CalibrationJob`` as a line of JSON, then the picture's pixels, blue green red. Standard output
gets a ``JobStep`` per line; the last has the ``Calibration`` or an error.
"""

import os
import sys
from typing import IO

import msgspec
import numpy as np

from vision_core.calibration.job import CalibrationJob
from vision_core.calibration.result import Calibration
from vision_core.calibration.solve import calibrate, from_other_end
from vision_core.calibration.start import Start, start_from_corners, start_from_settings
from vision_core.errors import PslvError
from vision_core.geometry import Bytes
from vision_core.pipeline.calibration_check import checked_by_robots
from vision_core.scheduling.attachment import end_with
from vision_core.types.job_step import JobStep


def main() -> None:
    """Do one job."""
    end_with(os.getppid())
    job = msgspec.json.decode(sys.stdin.buffer.readline(), type=CalibrationJob)
    pixels = _picture(sys.stdin.buffer, job.size_px)
    try:
        _tell(JobStep.of(run(job, pixels)))
    except PslvError as error:
        _tell(JobStep("refused", 1.0, error=str(error)))


def run(job: CalibrationJob, pixels: Bytes) -> Calibration:
    """The result of a job. Raises PslvError for corners that no camera sees so."""
    result = calibrate(
        [pixels],
        job.settings.field,
        _start(job),
        height_m=job.height_m,
        held=job.settings.camera.lens,
        marker_height_m=job.settings.robots.height_m,
        progress=lambda what, share: _tell(JobStep(what, share)),
    )
    result = from_other_end(result) if job.swaps_ends else result
    return checked_by_robots(result, pixels, job.settings)


def _start(job: CalibrationJob) -> Start | None:
    if job.corners_px is not None:
        held = job.settings.camera.lens
        corners = np.array(job.corners_px)
        return start_from_corners(corners, job.settings.field, job.size_px, height_m=job.height_m, held=held)
    return None if job.finds else start_from_settings(job.settings.camera, height_m=job.height_m)


def _picture(source: IO[bytes], size_px: tuple[int, int]) -> Bytes:
    width, height = size_px
    return np.frombuffer(source.read(width * height * 3), dtype=np.uint8).reshape(height, width, 3)


def _tell(step: JobStep) -> None:
    sys.stdout.buffer.write(step.encode())
    sys.stdout.flush()


if __name__ == "__main__":
    main()
