"""Gray pictures and raw mosaics are named; pictures in color, however pale, are not."""

import numpy as np

from tests.objects.drawing import CODES, Picture, overhead_camera
from vision_core.geometry import Bytes
from vision_core.regions.picture_kind import GRAY, MOSAIC, kind_reasons


def drawn() -> Bytes:
    picture = Picture(overhead_camera(0.005, 120, 90), 120, 90)
    picture.paint_robot("blue", CODES[3], 0.1, 0.05, 0.4)
    return picture.as_bytes()


def as_gray(levels: Bytes) -> Bytes:
    return np.repeat(levels[..., None], 3, axis=2)


def test_a_picture_in_color_is_one() -> None:
    assert kind_reasons(drawn()) == ()
    assert kind_reasons((drawn() // 8 + 100).astype(np.uint8)) == ()


def test_a_gray_picture_is_named() -> None:
    levels = drawn().mean(axis=2).astype(np.uint8)
    assert kind_reasons(as_gray(levels)) == (GRAY,)
    noise = np.random.default_rng(1).integers(-1, 2, drawn().shape)
    assert kind_reasons((as_gray(levels) + noise).clip(0, 255).astype(np.uint8)) == (GRAY,)


def test_a_raw_mosaic_is_named_in_every_order_of_its_colors() -> None:
    picture = drawn()
    for first in range(2):
        for second in range(2):
            raw = picture[..., 1].copy()
            raw[first::2, second::2] = picture[first::2, second::2, 2]
            raw[1 - first :: 2, 1 - second :: 2] = picture[1 - first :: 2, 1 - second :: 2, 0]
            assert kind_reasons(as_gray(raw)) == (MOSAIC,), (first, second)
