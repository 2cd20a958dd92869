"""Short jobs of set-up and calibration in a process of their own; their errors refuse the request that asked."""

from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from typing import TypeVar

import msgspec

from app.web.background import ask
from app.web.problems import RequestRefused
from vision_core.calibration.job import ShortJob
from vision_core.errors import PslvError
from vision_core.setup.jobs import SetupJob
from vision_core.startup import CALIBRATE, SET_UP

T = TypeVar("T")


def asked(job: SetupJob | ShortJob, form: type[T], what: str) -> T:
    """What a short job finds. what: what messages call it. Raises RequestRefused."""
    step = ask(CALIBRATE if isinstance(job, ShortJob) else SET_UP, msgspec.msgpack.encode(job), what)
    found = step.found(form)
    if found is None:
        question, found_words, accepted = _parts(step.error, what)
        raise RequestRefused(HTTPStatus.UNPROCESSABLE_ENTITY, question, found=found_words, accepted=accepted)
    return found


@contextmanager
def refused(status: HTTPStatus, field: str = "") -> Iterator[None]:
    """Turns our own errors into refusals of the request. field: of the form that is wrong."""
    try:
        yield
    except PslvError as error:
        raise RequestRefused(status, error.asked, found=error.found, accepted=error.accepted, field=field) from None


def _parts(error: str, what: str) -> tuple[str, str, str]:
    """What an error of a process asked, found and would accept."""
    question, _, rest = error.partition("; found: ")
    found, _, accepted = rest.partition("; accepted: ")
    return (question, found, accepted) if found else (what, error, "input that can be used")
