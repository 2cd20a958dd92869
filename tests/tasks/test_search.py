"""The task search suggests a robot that stands in glare for as long as it does."""

from collections.abc import Iterator

import pytest

from tests.glare import VEIL, Film
from tests.objects.drawing import SETTINGS
from tests.tasks.stage import Stage
from vision_core.rtdb import records
from vision_core.tasks import search

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]  # the first test may compile the hot path


@pytest.fixture
def stage() -> Iterator[Stage]:
    made = Stage(search, SETTINGS)
    yield made
    made.close()


def test_every_image_is_judged_alone(stage: Stage) -> None:
    film, told = Film(), records.suggestions("main").reader(stage.store)
    film.next()
    clear, hidden = film.frame().pixels, film.frame(VEIL).pixels
    stage.show(clear)
    assert told.value(stage.clock.now()).poses == ()
    stage.show(clear)
    assert told.sequence == 1  # all robots are read: this image is not searched
    for number in (2, 3, 4):
        stage.show(hidden)
        assert told.sequence == number
        ((_, _, x_m, y_m, _),) = told.value(stage.clock.now()).poses
        assert (x_m, y_m) == pytest.approx((film.robot.x_m, film.robot.y_m), abs=0.006)
    stage.show(clear)
    assert told.sequence == 4
