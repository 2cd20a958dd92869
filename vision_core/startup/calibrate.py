"""Short process beside a running service: calibrates the camera by pictures of the field, its lens by a board, or the
mirror of the on-board cameras by pairs; or finds pairs, an edge or the mirror's rim in an on-board picture.

Standard input has a ``CalibrationJob`` in msgpack. Standard output gets a ``JobStep`` per line; the last has the
``Calibration``, ``LensCalibration``, ``MirrorCalibration``, ``FoundPairs``, ``RadialEdge`` or ``Rim``, or an error.
"""

import os
import sys
from pathlib import Path

import msgspec
import numpy as np

from vision_core.calibration.board.lens import calibrate_lens
from vision_core.calibration.job import CalibrationJob, CameraJob, EdgeJob, LensJob, MirrorJob, PairsJob, RimJob
from vision_core.calibration.mirror.verdict import calibrate_mirror
from vision_core.calibration.result import Progress
from vision_core.calibration.solve import calibrate, from_other_end
from vision_core.calibration.start import Start, start_from_corners, start_from_settings
from vision_core.errors import PslvError
from vision_core.native.opencv import read_picture
from vision_core.pipeline.calibration_check import checked_by_robots
from vision_core.scheduling.attachment import end_with
from vision_core.startup.mirror_pairs import find_edge, find_mirror_rim, find_pairs, pairs_for
from vision_core.types.job_step import JobStep


def main() -> None:
    """Do one job."""
    end_with(os.getppid())
    job = msgspec.msgpack.decode(sys.stdin.buffer.read(), type=CalibrationJob)
    try:
        _tell(JobStep.of(run(job, lambda what, share: _tell(JobStep(what, share)))))
    except PslvError as error:
        _tell(JobStep("refused", 1.0, error=str(error)))


def run(job: CalibrationJob, progress: Progress) -> object:
    """The result of a job. Raises PslvError for pictures that cannot be read, and corners that no camera sees so."""
    if isinstance(job, EdgeJob):
        return find_edge(job)
    if isinstance(job, RimJob):
        return find_mirror_rim(job)
    if isinstance(job, PairsJob):
        return find_pairs(job, progress)
    if isinstance(job, MirrorJob):
        return calibrate_mirror(pairs_for(job), job.prior, job.settings.field, progress=progress)
    pictures = [read_picture(Path(one.path)) for one in job.pictures]
    names = [one.name for one in job.pictures]
    if isinstance(job, LensJob):
        return calibrate_lens(pictures, names, progress=progress)
    height, width, _ = pictures[0].shape
    result = calibrate(
        pictures,
        job.settings.field,
        _start(job, (width, height)),
        names=names,
        height_m=job.height_m,
        frees_measures=job.frees_measures,
        held=job.settings.camera.lens,
        marker_height_m=job.settings.robots.height_m,
        progress=progress,
    )
    result = from_other_end(result) if job.swaps_ends else result
    progress("comparing it with the robots", 1.0)
    return checked_by_robots(result, pictures[0], job.settings)


def _start(job: CameraJob, size_px: tuple[int, int]) -> Start | None:
    camera = job.settings.camera
    if job.corners_px is not None:
        corners = np.array(job.corners_px)
        return start_from_corners(corners, job.settings.field, size_px, height_m=job.height_m, held=camera.lens)
    return None if job.finds else start_from_settings(camera, height_m=job.height_m)


def _tell(step: JobStep) -> None:
    sys.stdout.buffer.write(step.encode())
    sys.stdout.flush()


if __name__ == "__main__":
    main()
