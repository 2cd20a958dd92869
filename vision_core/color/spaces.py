"""Color spaces that separate light from color.

The functions map rows of shape (n, 3), blue green red in 0..255, to rows of shape (n, 3). YMP and the ECImage are both
polar forms of the chroma (Cb, Cr): ``polar`` defines them, ``CHROMA`` tabulates it for whole pictures.
"""

import numpy as np
from numpy.typing import ArrayLike

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.types.colors import LUMA_BGR

GREY_LEVELS = 255.0
BLUE_WEIGHT, GREEN_WEIGHT, RED_WEIGHT = LUMA_BGR.tolist()
DARKEST_LUMA = 16.0
"""Lower limit of the luma in ratios to it: below, they would be mostly noise, and infinite at 0."""
FAINTEST_MODULE = 6.0
"""Below, the hue is mostly rounding and noise."""


def hsv_from_bgr(bgr: ArrayLike) -> Floats:
    """Hue [deg, 0 <= h < 360], saturation [0..1] and value [0..1] of Smith's hexcone.

    Greys have no hue: theirs is 0, so a range of hues needs a range of saturations.
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
    Greys have module 0 and phase 0, so a range of phases needs a range of modules.
    """
    luma, cb, cr = ycc_from_bgr(bgr).T
    return np.column_stack([luma, *polar(cb, cr)])


def ec_from_bgr(bgr: ArrayLike) -> Floats:
    """Luma [0..255], hue [deg, 0 <= h < 360] and saturation [0..1] of B-Human's ECImage.

    The hue is the angle of (Cb, Cr), nan where the chroma is too faint to have one. The saturation is
    |(Cb, Cr)| / luma, which separates black and white from colors in every light; at most 1, and below a luma of
    16 computed as if the luma were 16.
    Source: B-Human team report, "Image format and color spaces".
    """
    luma, cb, cr = ycc_from_bgr(bgr).T
    module, phase = polar(cb, cr)
    hue = np.where(module >= FAINTEST_MODULE, phase, np.nan)
    return np.column_stack([luma, hue, np.minimum(module / np.maximum(luma, DARKEST_LUMA), 1.0)])


def ycc_from_bgr(bgr: ArrayLike) -> Floats:
    """Luma [0..255] and the chroma Cb, Cr [-127.5..127.5] of ITU-R BT.601, full range."""
    blue, green, red = _channels(bgr)
    luma = RED_WEIGHT * red + GREEN_WEIGHT * green + BLUE_WEIGHT * blue
    cb = (blue - luma) * (0.5 / (1.0 - BLUE_WEIGHT))
    cr = (red - luma) * (0.5 / (1.0 - RED_WEIGHT))
    return np.column_stack([luma, cb, cr])


def bgr_from_ycc(ycc: Floats) -> Floats:
    """The inverse of ``ycc_from_bgr``, not clipped: rows of luma, Cb, Cr -> rows of blue green red."""
    luma, cb, cr = ycc.T
    blue, red = luma + 1.772 * cb, luma + 1.402 * cr
    return np.column_stack([blue, (luma - BLUE_WEIGHT * blue - RED_WEIGHT * red) / GREEN_WEIGHT, red])


def polar(cb: Floats, cr: Floats) -> tuple[Floats, Floats]:
    """Module and phase [deg, 0 <= p < 360] of chromas; results have their shape."""
    return np.hypot(cb, cr), np.degrees(np.arctan2(cr, cb)) % 360.0


def _chroma_table() -> Bytes:
    levels = np.arange(256.0) - 128.0
    module, phase = polar(levels[:, None], levels[None, :])
    return frozen(np.stack([module.round(), (phase * (256.0 / 360.0)).round() % 256.0], axis=-1).astype(np.uint8))


CHROMA = _chroma_table()
"""Module [0..181] and phase [256ths of a turn] of every (Cb, Cr) of a camera, where 128 is no chroma; shape
(256, 256, 2)."""


def _channels(bgr: ArrayLike) -> Floats:
    return np.asarray(bgr, dtype=np.float64).reshape(-1, 3).T
