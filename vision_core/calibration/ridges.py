"""Where a small version of the picture shows thin bright lines, whatever field they belong to.

A pixel is on a ridge if it is brighter than the pixels on both of its sides, in one of four directions. Distances to
ridges, one map per direction, say how well a whole field would lie on them: the sum is a hypothesis' error.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.calibration.profiles import FloatImage
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.native.opencv import distances_to, shrink, without_small_regions
from vision_core.types.colors import LUMA_BGR

SMALL_SIDE_PX = 800
ASIDE_PX = (2, 4, 7, 11)
"""Distances to the sides at which a pixel is compared: a ridge is narrower than the largest."""
DIRECTIONS = ((1, 0), (1, 1), (0, 1), (-1, 1))
"""Across the ridges, x and y; the index of one is the direction of a ridge."""
MIN_CONTRAST = 10.0
MIN_LENGTH_PX = 18
BEYOND = 1e3
"""Brightness beyond the picture's border: nothing is a ridge there."""
"""Shorter ridges are letters, markers and texture."""


@dataclass(frozen=True, slots=True, eq=False)
class Ridges:
    """Ridges of a picture that was made smaller."""

    scale: float
    """Small pixels per pixel."""
    mask: Mask
    """Shape (height, width)."""
    thin: Mask
    """The mask's pixels at which the brightness over the sides is largest across the ridge, shape (height, width)."""
    distances: NDArray[np.float32]
    """By a line's direction across (as DIRECTIONS), to ridges of about the same; shape (4, height, width)."""

    def errors(self, pixels: Floats, normals: Floats, shifts: NDArray[np.intp], cap_px: float) -> Floats:
        """Mean distance of points to ridges of their direction after each of several shifts.

        pixels, normals: shape (n, 2), of the whole picture; shifts: shape (m, 2) [small px]; cap_px: the largest
        distance that counts, and that of points outside. Returns shape (m,) [small px].
        """
        small = np.rint((pixels + 0.5) * self.scale - 0.5).astype(np.intp)
        rim = int(np.abs(shifts).max(initial=0))
        _, height, width = self.distances.shape
        capped = np.full((len(DIRECTIONS), height + 2 * rim + 2, width + 2 * rim + 2), cap_px, dtype=np.float32)
        capped[:, rim + 1 : -rim - 1, rim + 1 : -rim - 1] = np.minimum(self.distances, cap_px)
        x = np.clip(small[:, 0], -1, width) + rim + 1
        y = np.clip(small[:, 1], -1, height) + rim + 1
        first = (direction_of(normals) * capped.shape[1] + y) * capped.shape[2] + x
        index = first + (shifts[:, 1] * capped.shape[2] + shifts[:, 0])[:, None]
        errors: Floats = np.take(capped.ravel(), np.clip(index, 0, capped.size - 1)).mean(axis=1)
        return errors


def direction_of(normals: Floats) -> NDArray[np.intp]:
    """Index of DIRECTIONS nearest to vectors across a line, shape (..., 2) -> (...)."""
    angle = np.arctan2(np.nan_to_num(normals[..., 1]), np.nan_to_num(normals[..., 0], nan=1.0))
    direction: NDArray[np.intp] = np.rint(angle / (np.pi / 4.0)).astype(np.intp) % 4
    return direction


def find_ridges(pixels: Bytes) -> Ridges:
    """The ridges of a picture, shape (height, width, 3)."""
    height, width = pixels.shape[:2]
    small = shrink(pixels, round(SMALL_SIDE_PX * min(1.0, width / height)))
    luma = (small @ LUMA_BGR).astype(np.float32)
    over = np.stack([_over_sides(luma, direction) for direction in DIRECTIONS])
    best = over.max(axis=0)
    mask = without_small_regions(best >= MIN_CONTRAST, MIN_LENGTH_PX)
    kind = over.argmax(axis=0)
    maps = []
    for direction in range(len(DIRECTIONS)):
        apart = np.abs(kind - direction) % 4
        maps.append(distances_to(mask & ((apart != 2) | (over[direction] >= MIN_CONTRAST))))
    return Ridges(small.shape[1] / width, mask, mask & _crests(over, kind), np.stack(maps))


def _crests(over: FloatImage, kind: NDArray[np.intp]) -> Mask:
    """Which pixels are at least as much over their sides as their neighbours across the ridge."""
    crests = np.zeros(kind.shape, dtype=np.bool_)
    for direction, (x, y) in enumerate(DIRECTIONS):
        own = over[direction]
        crests |= (kind == direction) & (own >= _shifted(own, x, y, 0.0)) & (own > _shifted(own, -x, -y, 0.0))
    return crests


def _over_sides(luma: FloatImage, direction: tuple[int, int]) -> FloatImage:
    """How much brighter every pixel is than the brighter one of its sides; 0 or less: it is not."""
    best = np.zeros_like(luma)
    diagonal = all(direction)
    for aside in ASIDE_PX:
        step = max(round(aside * 0.7071), 1) if diagonal else aside
        x, y = direction[0] * step, direction[1] * step
        beside = np.maximum(_shifted(luma, x, y, BEYOND), _shifted(luma, -x, -y, BEYOND))
        np.maximum(best, luma - beside, out=best)
    return best


def _shifted(image: FloatImage, x: int, y: int, beyond: float) -> FloatImage:
    """The image's values at a distance; beyond its border another value."""
    height, width = image.shape
    result = np.full_like(image, beyond)
    rows, columns = slice(max(-y, 0), height - max(y, 0)), slice(max(-x, 0), width - max(x, 0))
    result[rows, columns] = image[max(y, 0) : height + min(y, 0), max(x, 0) : width + min(x, 0)]
    return result
