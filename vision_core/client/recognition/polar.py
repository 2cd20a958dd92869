"""The picture along rays from the mirror's center, by bilinear interpolation."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vision_core.client.recognition.geometry import PictureGeometry, ray_radii_px
from vision_core.geometry import Bytes, Mask, frozen

SHARE_BITS = 6
"""Of the fractions of a pixel."""
ONE = 1 << SHARE_BITS
FIELD_BITS = 8 + 2 * SHARE_BITS + 1
"""Three weighted channels share a 64-bit number, so that one gather and one product serve all of them."""
FIELDS = np.array([0, FIELD_BITS, 2 * FIELD_BITS])
HALF = sum(1 << (2 * SHARE_BITS - 1 + int(field)) for field in FIELDS)


def rays_of(picture: Bytes, geometry: PictureGeometry, directions: int) -> Bytes:
    """Blue green red of the samples of evenly spaced rays, the first one straight ahead, anticlockwise.

    picture: blue green red, of the geometry's size. Returns shape (directions, m, 3), m radii of ``ray_radii_px``.
    """
    places, weights = _map_of(geometry, directions)
    blue, green, red = np.moveaxis(picture.reshape(-1, 3), -1, 0).astype(np.int64)
    packed = blue | (green << FIELDS[1]) | (red << FIELDS[2])
    width = geometry.size_px[0]
    total = np.full(places.shape, HALF)
    for weight, offset in zip(weights, (0, 1, width, width + 1), strict=True):
        total += packed[places + offset] * weight
    fields = total[..., None] >> (FIELDS + 2 * SHARE_BITS)
    return np.asarray(fields.astype(np.uint8))  # what is above a field's 8 bits is cut


def touching(mask: Mask, geometry: PictureGeometry, directions: int) -> Mask:
    """Which samples lie between pixels of which at least one is in the mask, shape (height, width); (directions, m)."""
    places, _ = _map_of(geometry, directions)
    around = mask | np.roll(mask, -1, axis=1)
    around |= np.roll(around, -1, axis=0)
    return np.asarray(around.reshape(-1)[places])


@lru_cache(maxsize=8)
def _map_of(geometry: PictureGeometry, directions: int) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """Flat index of each sample's upper left pixel, shape (n, m), and the weights of its four, shape (4, n, m)."""
    angles = (2.0 * np.pi / directions * np.arange(directions))[:, None]
    radii = ray_radii_px(geometry)
    columns, rows = geometry.pixel_from_px(radii * np.cos(angles), radii * np.sin(angles))
    width, height = geometry.size_px
    columns, rows = np.clip(columns, 0.0, width - 1.001), np.clip(rows, 0.0, height - 1.001)
    left, upper = columns.astype(np.intp), rows.astype(np.intp)
    right = np.rint((columns - left) * ONE).astype(np.intp)
    lower = np.rint((rows - upper) * ONE).astype(np.intp)
    weights = [(ONE - right) * (ONE - lower), right * (ONE - lower), (ONE - right) * lower, right * lower]
    return frozen(upper * width + left), frozen(np.stack(weights))
