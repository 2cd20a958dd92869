"""Sensor noise: read noise, which is the same everywhere, and shot noise, which grows with the light.

They are independent, so their variances add: sigma^2 = read^2 + shot^2 * level (Janesick, "Photon Transfer",
2007, the noise of a linear sensor). A pool of normal numbers is drawn once; each image uses it from a random start.
"""

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes
from vision_core.native.kernels import kernel
from vision_core.settings.schema import SyntheticSettings

POOL_MARGIN = 1 << 16
"""The pool is longer than an image by so many numbers: an image's noise has as many possible starts."""
STEPS_PER_SIGMA = 30.0
"""The pool holds normal numbers as signed bytes in steps of sigma / 30; the largest is 4.2 sigma."""


class SensorNoise:
    """Noise for images of one size. values: width * height * 3."""

    def __init__(self, synthetic: SyntheticSettings, values: int) -> None:
        self._rng = np.random.default_rng([synthetic.seed, 4])
        normal = self._rng.standard_normal(values + POOL_MARGIN, dtype=np.float32)
        self._pool = (normal * STEPS_PER_SIGMA).round().clip(-127, 127).astype(np.int8)
        self._read_variance = np.float32((synthetic.read_noise / STEPS_PER_SIGMA) ** 2)
        self._shot_variance = np.float32((synthetic.shot_noise / STEPS_PER_SIGMA) ** 2)

    def add(self, pixels: Bytes) -> None:
        """Add noise to an image in place, shape (height, width, 3)."""
        if self._read_variance or self._shot_variance:
            start = int(self._rng.integers(POOL_MARGIN))
            add_noise(
                pixels.reshape(-1), self._pool[start : start + pixels.size], self._read_variance, self._shot_variance
            )


@kernel
def add_noise(values: Bytes, pool: NDArray[np.int8], read_variance: np.float32, shot_variance: np.float32) -> None:
    """Add noise in place: to every value its number of the pool times the sigma of its level; round and clip.

    The square root is computed for every value: with a table of 256 roots the compiler cannot vectorize the loop,
    which then takes eight times as long.
    """
    for i in range(len(values)):
        level = np.float32(values[i])
        noisy = level + np.sqrt(read_variance + shot_variance * level) * np.float32(pool[i]) + np.float32(0.5)
        values[i] = np.uint8(np.int32(min(max(noisy, np.float32(0.0)), np.float32(255.0))))
