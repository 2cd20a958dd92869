"""Noise has the statistics of a sensor: variances of read and shot noise add, means stay."""

import msgspec
import numpy as np
import pytest

from vision_core.capture.synthetic.noise import SensorNoise
from vision_core.geometry import Bytes
from vision_core.settings.schema import SyntheticSettings
from vision_core.venues.loader import load_settings

SHAPE = (200, 300, 3)
ROUNDING = 1.0 / 12.0
"""Variance of rounding to whole grey levels."""


def synthetic(read: float, shot: float, seed: int = 1) -> SyntheticSettings:
    return msgspec.structs.replace(load_settings().synthetic, read_noise=read, shot_noise=shot, seed=seed)


def noisy(noise: SensorNoise, level: int) -> Bytes:
    pixels = np.full(SHAPE, level, dtype=np.uint8)
    noise.add(pixels)
    return pixels


@pytest.mark.parametrize(("read", "shot"), [(3.0, 0.0), (0.0, 0.5), (2.0, 0.4)])
def test_variance_is_read_plus_shot_times_level(read: float, shot: float) -> None:
    noise = SensorNoise(synthetic(read, shot), int(np.prod(SHAPE)))
    for level in (40, 100, 160, 220):
        pixels = noisy(noise, level).astype(np.float64)
        assert pixels.mean() == pytest.approx(level, abs=0.1)
        assert pixels.var() == pytest.approx(read**2 + shot**2 * level + ROUNDING, rel=0.03)


def test_it_is_white_within_an_image_and_between_images() -> None:
    noise = SensorNoise(synthetic(5.0, 0.0), int(np.prod(SHAPE)))
    one, other = (noisy(noise, 100).astype(np.float64) - 100.0 for _ in range(2))
    assert abs((one[:, 1:] * one[:, :-1]).mean()) < 0.4
    assert abs((one * other).mean()) < 0.4


def test_it_clips_and_does_not_wrap() -> None:
    noise = SensorNoise(synthetic(5.0, 0.0), int(np.prod(SHAPE)))
    assert noisy(noise, 0).max() < 40
    assert noisy(noise, 255).min() > 215


def test_zero_noise_does_not_change_the_image() -> None:
    assert (noisy(SensorNoise(synthetic(0.0, 0.0), int(np.prod(SHAPE))), 77) == 77).all()


def test_equal_seeds_give_equal_noise() -> None:
    first, again, other = (SensorNoise(synthetic(3.0, 0.2, seed), int(np.prod(SHAPE))) for seed in (5, 5, 6))
    image = noisy(first, 90)
    assert np.array_equal(image, noisy(again, 90))
    assert not np.array_equal(image, noisy(other, 90))
