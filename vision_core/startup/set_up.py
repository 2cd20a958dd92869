"""Short process beside a running service: one step of setting up a venue.

Standard input has a job of ``vision_core.setup.jobs`` in msgpack. Standard output gets a ``JobStep`` per line; the last
has what was found, or an error.
"""

import os
import sys

import msgspec

from vision_core.errors import PslvError
from vision_core.scheduling.attachment import end_with
from vision_core.setup.jobs import SetupJob
from vision_core.setup.run import run
from vision_core.types.job_step import JobStep


def main() -> None:
    """Do one job."""
    end_with(os.getppid())
    job = msgspec.msgpack.decode(sys.stdin.buffer.read(), type=SetupJob)
    try:
        _tell(JobStep.of(run(job, lambda what, share: _tell(JobStep(what, share)))))
    except PslvError as error:
        _tell(JobStep("refused", 1.0, error=str(error)))


def _tell(step: JobStep) -> None:
    sys.stdout.buffer.write(step.encode())
    sys.stdout.flush()


if __name__ == "__main__":
    main()
