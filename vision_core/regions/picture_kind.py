"""Is a picture one in color? A gray one and a camera's raw mosaic are named as such: no color class can help there."""

import numpy as np

from vision_core.geometry import Bytes
from vision_core.types.reasons import Reason

STEP = 4
"""Every so many-th block of 2x2 pixels is looked at, along both axes."""
MAX_CHROMA = 3
"""Channels of a gray picture differ by no more, in all but MIN_GRAY of its pixels [grey levels]."""
MIN_GRAY = 0.999
MIN_MOSAIC, MOSAIC_RATIO = 6.0, 3.0
"""In a mosaic the greens differ so much from the other two of a block [grey levels], and so many times as much as
blocks from their neighbors."""
GRAY = Reason(
    "no color in this picture: its channels are equal, as those of a gray picture or a monochrome camera",
    "Take pictures in color: without them no marker can be told from another.",
    np.inf,
)
MOSAIC = Reason(
    "this picture is a raw Bayer mosaic: neighboring pixels are red, green and blue by turns, and it was read as gray",
    "Let the camera or its driver convert it to color (demosaic it) before it comes here.",
    np.inf,
)


def kind_reasons(pixels: Bytes) -> tuple[Reason, ...]:
    """What kind of picture it is, if it is none in color; () for one in color.

    pixels: shape (height, width, 3), blue green red.
    """
    height, width = (side // 2 * 2 for side in pixels.shape[:2])
    blocks = pixels[:height, :width].reshape(height // 2, 2, width // 2, 2, 3)[::STEP, :, ::STEP].astype(np.int64)
    if (np.ptp(blocks, axis=-1) <= MAX_CHROMA).mean() < MIN_GRAY:
        return ()
    gray = blocks[..., 1]
    across = (gray[:, 0, :, 1] + gray[:, 1, :, 0] - gray[:, 0, :, 0] - gray[:, 1, :, 1]) / 2.0
    along = np.abs(np.diff(gray[:, 0, :, 0], axis=1)).mean() if gray.shape[2] > 1 else 0.0
    contrast = abs(float(np.median(across)))
    return (MOSAIC,) if contrast >= MIN_MOSAIC and contrast >= MOSAIC_RATIO * min(along, MIN_MOSAIC) else (GRAY,)
