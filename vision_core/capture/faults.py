"""Faults of a simulated camera or of recorded pictures: what a service does then is tried without a screwdriver.

``FaultySource`` stands between a source that is no device and who takes its images. Which faults it has is said by the
live settings ``[faults]``, so tests, benchmarks and an operator's drill make them in the same way while the service
runs. ``changed_light`` is used for single pictures too (``evaluation.lights``).
"""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from vision_core.capture.source import PlayedSource
from vision_core.clock import Instant
from vision_core.geometry import Bytes
from vision_core.native.opencv import decode_jpeg, encode_jpeg
from vision_core.settings.schema import FaultSettings, LightFaultSettings
from vision_core.timing.rate_keeper import Keeper

Change = Callable[[Bytes], Bytes]
"""A picture, shape (height, width, 3), blue green red -> another one of its shape, in memory of its own or as it is."""

NO_LIGHT_FAULT = LightFaultSettings(
    gain_bgr=(1.0, 1.0, 1.0), black=0.0, gamma=1.0, right_half=1.0, noise=0.0, jpeg_quality=0
)
BORDER = 0.45, 0.55
"""Between these shares of the width the right half's light sets in."""
POOL_MARGIN = 1 << 16
"""The pool of noise is longer than an image by so many numbers: images have different parts of it."""
STEPS_PER_SIGMA = 30.0
"""The pool holds normal numbers as signed bytes in these steps."""


class FaultySource:
    """A source with the faults of the settings. Implements PlayedSource."""

    def __init__(self, source: PlayedSource, faults: FaultSettings) -> None:
        self._source = source
        self.description, self.repeats, self.rate_hz = source.description, source.repeats, source.rate_hz
        self.have(faults)

    @property
    def keeper(self) -> Keeper:
        """That of the source."""
        return self._source.keeper

    @keeper.setter
    def keeper(self, keeper: Keeper) -> None:
        self._source.keeper = keeper

    def have(self, faults: FaultSettings) -> None:
        """Have these faults from the next image on."""
        self._change = None if faults.light == NO_LIGHT_FAULT else changed_light(faults.light)

    def prepare(self) -> None:
        self._source.prepare()

    def grab(self, pixels: Bytes) -> Instant:
        instant = self._source.grab(pixels)
        if self._change is not None:
            np.copyto(pixels, self._change(pixels))
        return instant

    def close(self) -> None:
        self._source.close()


def changed_light(fault: LightFaultSettings) -> Change:
    """What another light, another curve of the camera or a poor connection does to pictures.

    In this order: gains, gamma, black level, light of the right half, noise, JPEG. Levels are taken as light in the
    gains, as cameras without a gamma have them.
    """
    levels = np.arange(256.0)
    curves = [
        255.0 * (np.clip(levels * gain, 0.0, 255.0) / 255.0) ** fault.gamma + fault.black for gain in fault.gain_bgr
    ]
    tables = np.clip(np.round(curves), 0.0, 255.0).astype(np.uint8)
    noises = np.random.default_rng(1)

    def change(pixels: Bytes) -> Bytes:
        changed: Bytes = np.stack([tables[channel][pixels[..., channel]] for channel in range(3)], axis=-1)
        if fault.right_half != 1.0:
            along = np.linspace(0.0, 1.0, pixels.shape[1], dtype=np.float32)
            share = np.clip((along - BORDER[0]) / (BORDER[1] - BORDER[0]), 0.0, 1.0) * (1.0 - fault.right_half)
            changed = np.clip((changed * (1.0 - share)[None, :, None]).round(), 0.0, 255.0).astype(np.uint8)
        if fault.noise:
            first = int(noises.integers(POOL_MARGIN))
            pool = _noise(pixels.size + POOL_MARGIN)[first : first + pixels.size].reshape(pixels.shape)
            noisy = changed + pool * np.float32(fault.noise / STEPS_PER_SIGMA)
            changed = np.clip(noisy.round(), 0.0, 255.0).astype(np.uint8)
        if fault.jpeg_quality:
            changed = decode_jpeg(encode_jpeg(changed, fault.jpeg_quality))
        return changed

    return change


@cache
def _noise(count: int) -> NDArray[np.int8]:
    """Normal numbers, drawn once."""
    drawn = np.random.default_rng(1).standard_normal(count, dtype=np.float32)
    return (drawn * STEPS_PER_SIGMA).round().clip(-127.0, 127.0).astype(np.int8)
