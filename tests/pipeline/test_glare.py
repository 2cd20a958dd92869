"""Robots whose colors a reflection hides: read by their shape, where the search or the last frame says they are."""

from typing import Any

import numpy as np
import pytest

from tests.glare import CAMERA, DOT, VEIL, Film
from tests.objects.drawing import PAINTS, SETTINGS
from vision_core.clock import Instant, ManualClock
from vision_core.objects.robots.held import MAX_MISSED
from vision_core.pipeline import perception as perception_module
from vision_core.pipeline.diagnosis import reasons_of
from vision_core.pipeline.perception import Perception, confirm_picture
from vision_core.types.image import ImageFrame
from vision_core.types.tables import NO_ID


@pytest.fixture(scope="module")
def perception() -> Perception:
    perception = Perception(SETTINGS, CAMERA)
    perception.warm_up()
    return perception


@pytest.mark.slow
def test_a_robot_that_drives_into_glare_is_held(perception: Perception) -> None:
    film, alone = Film(), Perception(SETTINGS, CAMERA)
    by_blobs = 0
    for number in range(20):
        film.next()
        frame = film.frame(VEIL if number >= 5 else 0.0)
        perception.perceive(frame, film.clock)
        (robot,) = film.read(perception.robots)
        assert film.is_right(robot)
        alone.perceive(ImageFrame("main", 1, Instant(0), frame.pixels), film.clock)
        by_blobs += len(film.read(alone.robots))
    assert by_blobs < 8


@pytest.mark.slow
def test_a_robot_that_is_lifted_is_not_held(perception: Perception) -> None:
    film = Film()
    for number in range(8):
        film.next()
        perception.perceive(film.frame(lifted=number >= 5), film.clock)
        assert len(film.read(perception.robots)) == (number < 5)


@pytest.mark.slow
def test_the_search_finds_a_robot_that_stands_in_glare(perception: Perception) -> None:
    film = Film()
    film.next()
    frame = film.frame(VEIL)
    perception.perceive(frame, film.clock)
    assert not len(film.read(perception.robots))
    others = len(perception.robots)
    perception.perceive_still(frame, film.clock)
    (robot,) = film.read(perception.robots)
    assert film.is_right(robot)
    assert len(perception.robots) == others + 1
    perception.perceive(frame, film.clock)
    assert not len(film.read(perception.robots))
    found = perception.unseen_robots()
    assert len(found.poses) == 1
    perception.suggest(found)
    perception.perceive(frame, film.clock)
    assert len(film.read(perception.robots)) == 1


@pytest.mark.slow
def test_a_robot_that_its_shape_tells_has_no_reason() -> None:
    film, perception = Film(), Perception(SETTINGS, CAMERA)
    film.next()
    frame = film.frame(VEIL, on=DOT)
    by_blobs = perception.perceive_alone(frame, film.clock).record()
    (reason,) = reasons_of(perception, by_blobs)
    assert "has no id: 4 of the 5 patches" in reason.text
    still = perception.perceive_still(frame, film.clock).record()
    assert reasons_of(perception, still) == ()


def test_an_empty_field_suggests_nothing(perception: Perception) -> None:
    pixels = np.full(CAMERA.shape, PAINTS["carpet"], dtype=np.uint8)
    frame = ImageFrame("main", 1, Instant(0), pixels)
    perception.perceive(frame, ManualClock())
    found = perception.unseen_robots()
    assert not len(found.poses)
    assert not (perception.robots["id"] != NO_ID).any()


@pytest.mark.slow
def test_shapes_are_looked_at_only_while_a_robot_is_missing(
    perception: Perception, monkeypatch: pytest.MonkeyPatch
) -> None:
    film, looked_at = Film(), []

    def confirm(*arguments: Any) -> None:
        looked_at.append(film.number)
        confirm_picture(*arguments)

    monkeypatch.setattr(perception_module, "confirm_picture", confirm)

    def see(frames: int, white: float = 0.0, *, lifted: bool = False) -> list[int]:
        looked_at.clear()
        for _ in range(frames):
            film.next()
            perception.perceive(film.frame(white, lifted=lifted), film.clock)
            assert len(film.read(perception.robots)) == (not lifted)
        return [number - film.number for number in looked_at]

    assert see(5) == []
    assert see(1, VEIL) == [0]
    assert see(3) == []
    assert see(MAX_MISSED + 2, lifted=True) == list(range(-MAX_MISSED - 1, -1))
