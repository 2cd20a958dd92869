"""Noise as a sensor makes it: read noise, the same everywhere, and shot noise, which grows with the light.

Both are independent, so their variances add: sigma^2 = read^2 + shot^2 * level (Janesick, "Photon Transfer",
2007, the noise of a linear sensor). Normal numbers are drawn once and used from another place for every image.
"""

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel
from vision_core.settings.schema import SyntheticSettings

SPARE = 1 << 16
"""The pool is longer than an image by so many numbers: the images' noises begin at as many places."""
STEPS_PER_SIGMA = 30.0
"""A pool number is a byte; the largest is 4.2 sigma."""


class SensorNoise:
    """Noise for images of one number of values."""

    def __init__(self, synthetic: SyntheticSettings, values: int) -> None:
        self._rng = np.random.default_rng([synthetic.seed, 4])
        normal = self._rng.standard_normal(values + SPARE, dtype=np.float32)
        self._pool = (normal * STEPS_PER_SIGMA).round().clip(-127, 127).astype(np.int8)
        self._read2 = np.float32((synthetic.read_noise / STEPS_PER_SIGMA) ** 2)
        self._shot2 = np.float32((synthetic.shot_noise / STEPS_PER_SIGMA) ** 2)

    def add(self, pixels: Bytes) -> None:
        """Add noise to an image in place, shape (height, width, 3)."""
        if self._read2 or self._shot2:
            start = int(self._rng.integers(SPARE))
            add_noise(pixels.reshape(-1), self._pool[start : start + pixels.size], self._read2, self._shot2)


@kernel
def add_noise(values: Bytes, pool: NDArray[np.int8], read2: np.float32, shot2: np.float32) -> None:
    """Add to every value the pool's number times the sigma of its level; round and clip, in place.

    The root is worked out for every value: a table of 256 would keep the loop from being vectorized, and
    takes eight times as long.
    """
    for i in range(len(values)):
        level = np.float32(values[i])
        noisy = level + np.sqrt(read2 + shot2 * level) * np.float32(pool[i]) + np.float32(0.5)
        values[i] = np.uint8(np.int32(min(max(noisy, np.float32(0.0)), np.float32(255.0))))
