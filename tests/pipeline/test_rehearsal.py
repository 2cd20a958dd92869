"""A film perceived with rehearsals and without: the same sightings, byte for byte."""

import itertools

import pytest

from tests.glare import Film
from tests.objects.drawing import SETTINGS
from vision_core.clock import ManualClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.perception import Perception

CAMERA = CameraSetup.from_settings(SETTINGS)
FRAMES = 40

pytestmark = pytest.mark.slow


def test_a_rehearsal_leaves_no_trace() -> None:
    film, plain, rehearsed = Film(), Perception(SETTINGS, CAMERA), Perception(SETTINGS, CAMERA)
    for perception in (plain, rehearsed):
        perception.warm_up()
    stages = itertools.cycle([3, 1, 2])
    for number in range(FRAMES):
        film.next()
        frame = film.frame(white=1.0 if number % 7 == 3 else 0.0, lifted=number % 11 == 5)
        seen = [bytes(perception.perceive(frame, ManualClock()).bytes) for perception in (plain, rehearsed)]
        assert seen[0] == seen[1], number
        for _ in range(number % 3):
            answers = itertools.chain(itertools.repeat(False, next(stages) - 1), itertools.repeat(True))
            rehearsed.rehearse(lambda answers=answers: next(answers))  # type: ignore[misc]
        assert rehearsed.rehearse(lambda: False)
        assert rehearsed.blob_count == plain.blob_count
        for name in ("expected", "windows"):
            assert (getattr(rehearsed.context, name) == getattr(plain.context, name)).all()
        assert (rehearsed.context.segment.cursor == plain.context.segment.cursor).all()
        assert bytes(rehearsed.robots.tobytes()) == plain.robots.tobytes()


def test_without_a_frame_there_is_nothing_to_rehearse() -> None:
    assert not Perception(SETTINGS, CAMERA).rehearse(lambda: False)
