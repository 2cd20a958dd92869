"""3. color classes -> blobs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats


@dataclass(frozen=True, slots=True)
class Blobs:
    """Connected regions of one color class, as arrays of equal length n, in scan order."""

    color: Bytes
    """Class of the ColorTable, shape (n,)."""
    area_px: NDArray[np.int64]
    """Shape (n,)."""
    center_px: Floats
    """Centroid x, y in the image, shape (n, 2)."""
    box_px: NDArray[np.int64]
    """Bounding box x0, y0, x1, y1, all inclusive, shape (n, 4)."""
    complete: bool
    """False when the tables overflowed and regions were lost."""

    def __len__(self) -> int:
        return len(self.area_px)
