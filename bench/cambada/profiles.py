"""Brightness across a path on the floor: is there a painted line, or an edge, and how far aside?"""

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel

LUMA = np.array([0.114, 0.587, 0.299])
REACH_PX = 4
"""What is looked for may lie so far from its place: calibrations are not perfect."""
ASIDE_PX = 3
"""A line is compared with what lies so far on both of its sides, an edge with a third of that."""
CONTRAST = 15.0
"""Grey levels by which paint or a wall differs from carpet."""
AGREE_PX = 1.5
MIN_SHARE = 0.3
"""Of the points, that must see it, less than AGREE_PX from where their median does: robots may hide the rest."""
FEWEST = 8
STEP_M = 1e-3


class Strip:
    """The pixels across a path, in one camera's images."""

    def __init__(self, camera: CameraModel, path_m: Floats, across: Floats, size_px: tuple[int, int]) -> None:
        """path_m: points on the floor, shape (n, 2); across: unit vectors there, same shape; size_px: of the images."""
        here = camera.pixel_from_field(path_m)
        normal = camera.pixel_from_field(path_m + STEP_M * across) - here
        normal /= np.hypot(normal[:, 0], normal[:, 1])[:, None]
        steps = np.arange(-REACH_PX - ASIDE_PX, REACH_PX + ASIDE_PX + 1)
        places = here[:, None] + steps[:, None] * normal[:, None]
        with np.errstate(invalid="ignore"):
            kept = ((places >= 0.0) & (places <= np.array(size_px) - 1.0)).all(axis=(1, 2))
        self.normal: Floats = normal[kept].mean(axis=0) if kept.any() else np.zeros(2)
        """Mean direction across, in the image."""
        x, y = np.moveaxis(places[kept].round().astype(np.intp), -1, 0)
        self._index = y * size_px[0] + x
        self._middle_px: Floats = here[kept].mean(axis=0) if kept.any() else np.zeros(2)

    def line_px(self, pixels: Bytes) -> float | None:
        """How far along `normal` a bright line lies from the path [px]; None: there is none. pixels: (h, w, 3)."""
        luma = self._luma(pixels)
        middle = luma[:, ASIDE_PX:-ASIDE_PX]
        rises = middle - np.maximum(luma[:, : -2 * ASIDE_PX], luma[:, 2 * ASIDE_PX :])
        return _agreed(rises)

    def edge_px(self, pixels: Bytes) -> float | None:
        """How far along `normal` from the path it turns brighter [px]; None: it does not. pixels: (h, w, 3)."""
        luma = self._luma(pixels)
        return _agreed(luma[:, ASIDE_PX + 1 : 1 - ASIDE_PX] - luma[:, ASIDE_PX - 1 : -ASIDE_PX - 1])

    def middle_px(self, aside_px: float) -> tuple[float, float]:
        """The middle of the path, shifted along `normal`."""
        x, y = (self._middle_px + aside_px * self.normal).tolist()
        return x, y

    def _luma(self, pixels: Bytes) -> Floats:
        luma: Floats = np.take(pixels.reshape(-1, 3), self._index, axis=0) @ LUMA
        return luma


def normals(path_m: Floats) -> NDArray[np.float64]:
    """Unit vectors across a path, to its left, shape (n, 2)."""
    along = np.gradient(path_m, axis=0)
    turned: Floats = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(along[:, 0], along[:, 1])[:, None]
    return turned


def _agreed(rises: Floats) -> float | None:
    """Where most points see the largest rise [px]; rises: shape (points, 2 REACH_PX + 1)."""
    if len(rises) < FEWEST:
        return None
    clear = rises.max(axis=1) >= CONTRAST
    if not clear.any():
        return None
    found = rises.argmax(axis=1)[clear] - REACH_PX
    middle = float(np.median(found))
    agree = np.abs(found - middle) <= AGREE_PX
    return float(found[agree].mean()) if agree.sum() >= MIN_SHARE * len(rises) else None
