"""A bit per pixel, 64 pixels in a word: what was flooded, and what is masked."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Mask, frozen
from vision_core.native.kernels import kernel

Bits: TypeAlias = NDArray[np.uint64]
"""Shape (height, width / 64 rounded up)."""


def bits_of(mask: Mask | None) -> Bits | None:
    """The bits of a mask, shape (height, width); None for None, for which kernels are compiled without any test."""
    if mask is None:
        return None
    height, width = mask.shape
    padded = np.zeros((height, -(-width // 64) * 64), dtype=np.bool_)
    padded[:, :width] = mask
    words: Bits = np.packbits(padded, axis=1, bitorder="little").view("<u8").astype(np.uint64)
    return frozen(words)


@kernel
def is_set(bits: Bits, y: int, x: int) -> bool:
    """Whether a pixel has its bit."""
    return bool((bits[y, x >> 6] >> np.uint64(x & 63)) & np.uint64(1))


@kernel
def is_masked(masked: Bits | None, y: int, x: int) -> bool:
    """Whether a pixel is masked; without masks this is compiled to nothing."""
    if masked is None:
        return False
    return is_set(masked, y, x)


@kernel
def masked_word(masked: Bits | None, y: int, word: int) -> np.uint64:
    """The bits of 64 masked pixels; 0 without masks."""
    if masked is None:
        return np.uint64(0)
    bits: np.uint64 = masked[y, word]
    return bits
