"""A ball that fills no pixel is found by its share of light, and what resembles it is not."""

from dataclasses import replace

import numpy as np
import pytest

from vision_core.client.recognition import RENDERED, PictureGeometry, paper_geometry
from vision_core.client.recognition.palette import Surface
from vision_core.client.recognition.small_ball import find_small_ball
from vision_core.geometry import Bytes, Floats
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.messages import Ball

GEOMETRY: PictureGeometry = paper_geometry(PAPER_MIRROR)
FLOOR, WHITE, BALL, YELLOW = (40, 105, 50), (232, 236, 228), (250, 120, 30), (235, 210, 40)
EDGE_PX = 100.0
AHEAD_PX = 60.0


def picture_with(share: float, rgb: tuple[int, int, int] = BALL, light: float = 1.0, noise: float = 2.0) -> Bytes:
    """Floor of an uneven light up to white walls, with two pixels ahead that are a mix of it and another color."""
    rng = np.random.default_rng(4)
    columns, rows = np.meshgrid(np.arange(320.0), np.arange(240.0))
    radius, _ = GEOMETRY.px_from_pixel(columns, rows)
    picture: Floats = np.where((radius < EDGE_PX)[..., None], np.array(FLOOR), np.array(WHITE)).astype(np.float64)
    picture *= light * (1.0 + 0.2 * np.sin(columns / 9.0))[..., None]
    column, row = GEOMETRY.pixel_from_px(np.array([AHEAD_PX]), np.zeros(1))
    there = int(row[0]), slice(int(column[0]), int(column[0]) + 2)
    picture[there] = (1.0 - share) * picture[there] + share * light * np.array(rgb)
    picture += rng.normal(0.0, noise, picture.shape)
    return np.ascontiguousarray(picture.clip(0.0, 255.0).round().astype(np.uint8)[..., ::-1])


def found_in(picture: Bytes, letter: str = "w", edge_px: float = EDGE_PX) -> Ball:
    return find_small_ball(picture, np.full(360, letter), np.full(360, edge_px), GEOMETRY, RENDERED)


@pytest.mark.parametrize("light", [0.5, 1.0])
def test_half_a_pixel_of_it_is_found_in_any_light(light: float) -> None:
    ball = found_in(picture_with(0.4, light=light))
    assert ball.px == pytest.approx(AHEAD_PX, abs=1.0)
    assert min(ball.direction_deg, 360 - ball.direction_deg) <= 1
    assert ball.size_deg == 1


def test_less_than_half_a_pixel_is_not_told_from_noise() -> None:
    assert found_in(picture_with(0.15)).hidden
    assert found_in(picture_with(0.4, noise=25.0)).hidden


@pytest.mark.parametrize("rgb", [FLOOR, WHITE, (30, 29, 30), (20, 90, 200)])
def test_floor_lines_dark_feet_and_blue_are_none_of_it(rgb: tuple[int, int, int]) -> None:
    assert found_in(picture_with(0.8, rgb)).hidden


def test_it_is_found_close_before_a_wall_and_not_beside_something_of_like_color() -> None:
    picture = picture_with(0.6)
    assert not found_in(picture, "w", AHEAD_PX).hidden
    assert found_in(picture, "y", AHEAD_PX).hidden
    assert found_in(picture, "v", AHEAD_PX).hidden
    assert not found_in(picture, "u", AHEAD_PX).hidden


def test_nothing_is_searched_beyond_the_edges() -> None:
    assert found_in(picture_with(0.8), "w", AHEAD_PX - 5.0).hidden


def test_a_wall_of_the_color_of_wood_is_none_of_it() -> None:
    wood = (178, 148, 110)
    palette = replace(RENDERED, colors=(*RENDERED.colors, (Surface.WALL, wood)))
    letters, edges = np.full(360, "w"), np.full(360, EDGE_PX)
    picture = picture_with(0.8, wood)
    assert find_small_ball(picture, letters, edges, GEOMETRY, palette).hidden
    assert not find_small_ball(picture_with(0.5), letters, edges, GEOMETRY, palette).hidden


def test_a_palette_without_white_or_with_a_ball_as_green_as_the_floor_finds_none() -> None:
    letters, edges = np.full(360, "w"), np.full(360, EDGE_PX)
    for lost in (Surface.WALL, Surface.BALL, Surface.FLOOR):
        palette = replace(RENDERED, colors=tuple(item for item in RENDERED.colors if item[0] is not lost))
        assert find_small_ball(picture_with(0.5), letters, edges, GEOMETRY, palette).hidden
    green = tuple((surface, FLOOR if surface is Surface.BALL else rgb) for surface, rgb in RENDERED.colors)
    assert find_small_ball(picture_with(0.5), letters, edges, GEOMETRY, replace(RENDERED, colors=green)).hidden
