"""Masks of a camera: polygons in its picture in which nothing is looked for."""

from collections.abc import Sequence

import numpy as np

from vision_core.geometry import Floats, Mask, frozen
from vision_core.settings.schema import MaskSettings


def masked_pixels(masks: Sequence[MaskSettings], size_px: tuple[int, int]) -> Mask | None:
    """Which pixels have their center in a polygon (even-odd rule), shape (height, width); None without polygons.

    size_px: width and height of the picture.
    """
    if not masks:
        return None
    width, height = size_px
    masked = np.zeros((height, width), dtype=np.bool_)
    for mask in masks:
        _fill(masked, np.array(mask.points_px, dtype=np.float64))
    return frozen(masked)


def _fill(masked: Mask, corners: Floats) -> None:
    """Set the pixels inside one polygon. corners: shape (n, 2)."""
    after = np.roll(corners, -1, axis=0)
    low, high = corners[:, 1].min(), corners[:, 1].max()
    for y in range(max(int(np.floor(low)), 0), min(int(np.ceil(high)) + 1, len(masked))):
        crosses = (corners[:, 1] <= y) != (after[:, 1] <= y)
        start, end = corners[crosses], after[crosses]
        places = np.sort(start[:, 0] + (y - start[:, 1]) / (end[:, 1] - start[:, 1]) * (end[:, 0] - start[:, 0]))
        for left, right in places.reshape(-1, 2).tolist():
            masked[y, max(int(np.ceil(left)), 0) : max(int(np.floor(right)) + 1, 0)] = True
