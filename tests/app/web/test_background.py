"""Jobs in processes of their own: they end when they are done, not with the request that began them."""

import threading
from pathlib import Path

import msgspec
import numpy as np
import pytest

from app.web.background import NO_RESULT, BackgroundJob, JobState, ask
from app.web.problems import RequestRefused
from tests.app.fake_service import wait_for
from vision_core.native.opencv import write_picture
from vision_core.setup.findings import Looked
from vision_core.setup.jobs import Look
from vision_core.startup import SET_UP
from vision_core.types.job_step import JobStep

CHATTER = "this"
"""A module that prints what is no step of a job."""


@pytest.fixture
def look(tmp_path: Path) -> bytes:
    path = tmp_path / "a.png"
    write_picture(path, np.random.default_rng(1).integers(0, 255, (48, 64, 3), dtype=np.uint8))
    return msgspec.msgpack.encode(Look(str(path), "a.png", None, needs_color=True))


def test_a_job_outlives_the_thread_that_began_it(look: bytes) -> None:
    told: list[JobStep] = []
    job = BackgroundJob("a look")
    thread = threading.Thread(target=job.start, args=(SET_UP, look, told.append))
    thread.start()
    thread.join()
    with pytest.raises(RequestRefused, match="one is under way"):
        job.start(SET_UP, look)
    wait_for(lambda: job.state is not JobState.RUNNING, 60.0)
    assert job.state.value == "done"
    assert job.step.found(Looked) == Looked(64, 48)
    assert [step.found(Looked) for step in told] == [Looked(64, 48)]
    job.forget()
    assert job.state.value == "none"


def test_a_job_that_says_nothing_useful_has_failed() -> None:
    job = BackgroundJob("a look")
    job.start(CHATTER, b"")
    wait_for(lambda: job.state is not JobState.RUNNING, 60.0)
    assert (job.state, job.step.error) == (JobState.FAILED, NO_RESULT)
    with pytest.raises(RequestRefused, match=NO_RESULT):
        ask(CHATTER, b"", "a look")


def test_what_cannot_be_kept_fails_the_job(look: bytes) -> None:
    def full(_step: JobStep) -> None:
        raise OSError("no space left")

    job = BackgroundJob("a look")
    job.start(SET_UP, look, full)
    wait_for(lambda: job.state is not JobState.RUNNING, 60.0)
    assert (job.state, job.step.error) == (JobState.FAILED, "no space left")


def test_a_cancelled_job_is_over(look: bytes) -> None:
    told: list[JobStep] = []
    job = BackgroundJob("a look")
    job.start(SET_UP, look, told.append)
    job.cancel()
    assert job.state is JobState.CANCELLED
    wait_for(lambda: not _is_busy(job), 60.0)
    assert job.state is JobState.CANCELLED
    assert told == []


def _is_busy(job: BackgroundJob) -> bool:
    try:
        job.check_idle()
    except RequestRefused:
        return True
    return False
