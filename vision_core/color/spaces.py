"""Color spaces that keep light apart from color. All functions map rows of shape (n, 3), blue green red
in 0..255, to rows of shape (n, 3)."""

import numpy as np
from numpy.typing import ArrayLike

from vision_core.geometry import Floats

GREY_LEVELS = 255.0


def hsv_from_bgr(bgr: ArrayLike) -> Floats:
    """Hue [deg, 0 <= h < 360], saturation [0..1] and value [0..1] of Smith's hexcone.

    Greys have no hue: theirs is 0, so bound the saturation wherever you bound the hue.
    Source: A. R. Smith, "Color gamut transform pairs", SIGGRAPH 1978.
    """
    blue, green, red = _channels(bgr)
    value = np.maximum(np.maximum(blue, green), red)
    chroma = value - np.minimum(np.minimum(blue, green), red)
    step = np.where(chroma > 0.0, chroma, 1.0)
    sextant = np.select(
        [value == red, value == green],
        [(green - blue) / step, (blue - red) / step + 2.0],
        (red - green) / step + 4.0,
    )
    hue = np.where(chroma > 0.0, 60.0 * sextant, 0.0) % 360.0
    saturation = chroma / np.where(value > 0.0, value, 1.0)
    return np.column_stack([hue, saturation, value / GREY_LEVELS])


def ymp_from_bgr(bgr: ArrayLike) -> Floats:
    """Luma [0..255], module [0..181] and phase [deg, 0 <= p < 360] of the chroma (Cb, Cr).

    The space of the CAMBADA robots (Neves et al., modular vision, section 3): luma as in YUV, module
    and phase the polar coordinates of the UV plane; here with the weights of ITU-R BT.601, full range.
    The module does not grow when a color darkens towards black, as the saturation of HSV does.
    Greys have module 0 and phase 0, so bound the module wherever you bound the phase.
    """
    blue, green, red = _channels(bgr)
    luma = 0.299 * red + 0.587 * green + 0.114 * blue
    cb = (blue - luma) * (0.5 / (1.0 - 0.114))
    cr = (red - luma) * (0.5 / (1.0 - 0.299))
    return np.column_stack([luma, np.hypot(cb, cr), np.degrees(np.arctan2(cr, cb)) % 360.0])


def _channels(bgr: ArrayLike) -> Floats:
    return np.asarray(bgr, dtype=np.float64).reshape(-1, 3).T
