"""A task gets at the records of its line, and at no others."""

import os
import time
from collections.abc import Iterator
from dataclasses import replace

import pytest

from tests.scheduling.tables import line
from vision_core.clock import Instant
from vision_core.errors import ServiceError
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb.items import packed
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.store import create_block
from vision_core.rtdb.task import PERIOD
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle
from vision_core.venues.loader import load_settings

SEEN, TOLD, OTHER = (packed(name, int, 64, 1.0) for name in ("seen", "told", "other"))
TASK = line("mine", PERIOD, ("seen",), ("told",), "mine", period_s=0.1)
SPECS = (*(item.spec for item in (SEEN, TOLD, OTHER)), RecordSpec("heartbeat/mine", 8, 1.0))


@pytest.fixture
def handle() -> Iterator[Handle]:
    block, wake = create_block(SPECS), os.eventfd(0, os.EFD_NONBLOCK)
    resources = ChildResources("mine", os.getpid(), 0, block, SPECS, wake, {}, {})
    attachment = Attachment(resources)
    yield Handle(TASK, attachment, load_settings(), CameraSetup.from_settings(load_settings()))
    attachment.store.close()
    os.close(block)
    os.close(wake)


def test_records_of_its_line_are_read_and_written(handle: Handle) -> None:
    SEEN.writer(handle.attachment.store).write(5, Instant(1), Instant(2))
    assert handle.reader(SEEN).value(Instant(3)) == 5
    handle.writer(TOLD).write(6, Instant(1), Instant(2))
    assert TOLD.reader(handle.attachment.store).value(Instant(3)) == 6


def test_other_records_are_refused_by_name(handle: Handle) -> None:
    with pytest.raises(ServiceError, match="task mine reads other; found: its line .* does not say so; accepted: seen"):
        handle.reader(OTHER)
    with pytest.raises(ServiceError, match="task mine writes seen; .* accepted: told"):
        handle.writer(SEEN)


def test_it_beats_while_it_waits_and_sleeps(handle: Handle) -> None:
    beats = handle.attachment.store.reader("heartbeat/mine")
    assert not handle.wait(0.25)
    waited = beats.sequence
    assert waited >= 2
    handle.sleep(0.25)
    assert beats.sequence >= waited + 2


def test_who_is_released_by_the_clock_sleeps_instead_of_waiting(handle: Handle) -> None:
    attachment = handle.attachment
    attachment.resources = replace(attachment.resources, wake=None)
    began = time.monotonic()
    assert not handle.wait(0.15)
    assert time.monotonic() - began >= 0.15


def test_a_raised_event_ends_the_wait(handle: Handle) -> None:
    assert handle.attachment.resources.wake is not None
    os.eventfd_write(handle.attachment.resources.wake, 1)
    assert handle.wait(5.0)
