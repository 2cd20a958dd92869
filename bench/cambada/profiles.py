"""Detects a painted line or an edge of brightness along a path on the floor, and measures its lateral offset."""

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel

LUMA = np.array([0.114, 0.587, 0.299])
SEARCH_PX = 4
"""Largest offset from the path at which lines and edges are found; calibrations are not perfect."""
COMPARE_PX = 3
"""A line is compared with the pixels at this distance on both of its sides, an edge with those at a third of it."""
CONTRAST = 15.0
"""Least difference between paint or wall and carpet [grey levels]."""
INLIER_PX = 1.5
MIN_INLIERS = 0.3
"""Least share of the path's points whose offset is within INLIER_PX of the median; robots may hide the rest."""
MIN_POINTS = 8
"""Fewer visible points give no result."""
STEP_M = 1e-3
"""Step across the path from which its normal in the image is computed."""


class Strip:
    """The pixels on both sides of a path, in one camera's images."""

    def __init__(self, camera: CameraModel, path_m: Floats, across: Floats, size_px: tuple[int, int]) -> None:
        """path_m: points on the floor, shape (n, 2) [m]; across: the path's unit normals there, same shape.

        size_px: width and height of the images.
        """
        here = camera.pixel_from_field(path_m)
        normal = camera.pixel_from_field(path_m + STEP_M * across) - here
        normal /= np.hypot(normal[:, 0], normal[:, 1])[:, None]
        steps = np.arange(-SEARCH_PX - COMPARE_PX, SEARCH_PX + COMPARE_PX + 1)
        places = here[:, None] + steps[:, None] * normal[:, None]
        with np.errstate(invalid="ignore"):
            kept = ((places >= 0.0) & (places <= np.array(size_px) - 1.0)).all(axis=(1, 2))
        self.normal: Floats = normal[kept].mean(axis=0) if kept.any() else np.zeros(2)
        """Mean unit normal in the image, shape (2,)."""
        x, y = np.moveaxis(places[kept].round().astype(np.intp), -1, 0)
        self._index = y * size_px[0] + x
        self._middle_px: Floats = here[kept].mean(axis=0) if kept.any() else np.zeros(2)

    def line_px(self, pixels: Bytes) -> float | None:
        """Offset of a bright line from the path, along `normal` [px], or None. pixels: shape (height, width, 3)."""
        luma = self._luma(pixels)
        middle = luma[:, COMPARE_PX:-COMPARE_PX]
        rises = middle - np.maximum(luma[:, : -2 * COMPARE_PX], luma[:, 2 * COMPARE_PX :])
        return _robust_offset(rises)

    def edge_px(self, pixels: Bytes) -> float | None:
        """Offset of an edge from dark to bright, along `normal` [px], or None. pixels: shape (height, width, 3)."""
        luma = self._luma(pixels)
        return _robust_offset(luma[:, COMPARE_PX + 1 : 1 - COMPARE_PX] - luma[:, COMPARE_PX - 1 : -COMPARE_PX - 1])

    def middle_px(self, offset_px: float) -> tuple[float, float]:
        """The middle of the path, shifted along `normal` by an offset [px]."""
        x, y = (self._middle_px + offset_px * self.normal).tolist()
        return x, y

    def _luma(self, pixels: Bytes) -> Floats:
        luma: Floats = np.take(pixels.reshape(-1, 3), self._index, axis=0) @ LUMA
        return luma


def normals(path_m: Floats) -> NDArray[np.float64]:
    """Unit normals of a path, to its left, shape (n, 2). path_m: shape (n, 2)."""
    along = np.gradient(path_m, axis=0)
    turned: Floats = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(along[:, 0], along[:, 1])[:, None]
    return turned


def _robust_offset(rises: Floats) -> float | None:
    """Mean offset of the largest rise over the inliers [px]; None: too few. rises: shape (points, 2 SEARCH_PX + 1)."""
    if len(rises) < MIN_POINTS:
        return None
    has_rise = rises.max(axis=1) >= CONTRAST
    if not has_rise.any():
        return None
    offsets = rises.argmax(axis=1)[has_rise] - SEARCH_PX
    median = float(np.median(offsets))
    inliers = np.abs(offsets - median) <= INLIER_PX
    return float(offsets[inliers].mean()) if inliers.sum() >= MIN_INLIERS * len(rises) else None
