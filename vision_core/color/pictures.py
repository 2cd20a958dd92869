"""The axes of color spaces as pictures, to find good bounds of a color class by eye."""

import numpy as np

from vision_core.color.spaces import (
    CHROMA,
    DARKEST_LUMA,
    FAINTEST_MODULE,
    GREY_LEVELS,
    bgr_from_ycc,
    hsv_from_bgr,
)
from vision_core.geometry import Bytes
from vision_core.native.opencv import ycc_picture

TURN = 256
"""Angles in pictures are bytes: 256ths of a turn."""
SHOWN_LUMA, SHOWN_MODULE = 140.0, 90.0
"""Of the colors that show an angle."""
MAX_MODULE = 181.0
FAINTEST_SATURATION = 0.08
"""Below, a hue is shown as none."""
DARK = np.uint8(40)
"""Grey level of pixels without a hue."""


def ymp_picture(pixels: Bytes) -> Bytes:
    """Luma, module and phase [256ths of a turn] of every pixel: shape (height, width, 3) -> the same, CAMBADA's YMP."""
    ycc = ycc_picture(pixels)
    return np.dstack([ycc[..., 0], CHROMA[ycc[..., 1], ycc[..., 2]]])


def ec_picture(pixels: Bytes) -> Bytes:
    """Luma, hue [256ths of a turn] and saturation [255ths] of every pixel, B-Human's ECImage: same shape.

    The saturation is clamped to 255. The hue of a module under 6 has no meaning.
    """
    luma, module, phase = np.moveaxis(ymp_picture(pixels), -1, 0)
    ratio = module.astype(np.float32) / np.maximum(luma, np.float32(DARKEST_LUMA))
    return np.dstack([luma, phase, np.minimum(ratio * GREY_LEVELS, GREY_LEVELS).astype(np.uint8)])


def axis_pictures(pixels: Bytes, space: str) -> dict[str, Bytes]:
    """Hue and strength of color of a picture as pictures, by name: shape (height, width, 3), blue green red.

    A hue is shown as the color that has it, at one luma; greys, which have no hue, are dark. The strength is shown as a
    grey level; white is the end of its scale.
    """
    if space == "hsv":
        rows = hsv_from_bgr(pixels)
        hue, strength = (rows[:, 0] * (TURN / 360.0)).astype(np.uint8), rows[:, 1]
        return {
            "hue": _colored(
                hue.reshape(pixels.shape[:2]), (strength > FAINTEST_SATURATION).reshape(pixels.shape[:2]), _hsv_wheel()
            ),
            "saturation": _grey((strength * GREY_LEVELS).reshape(pixels.shape[:2])),
        }
    _, module, phase = np.moveaxis(ymp_picture(pixels), -1, 0)
    hue = _colored(phase, module >= FAINTEST_MODULE, _chroma_wheel())
    if space == "ymp":
        return {"phase": hue, "module": _grey(module * (GREY_LEVELS / MAX_MODULE))}
    return {"hue": hue, "saturation": _grey(ec_picture(pixels)[..., 2])}


def _chroma_wheel() -> Bytes:
    """The color of each phase of YMP, shape (256, 3)."""
    radians = np.arange(TURN) * (2.0 * np.pi / TURN)
    luma = np.full(TURN, SHOWN_LUMA)
    ycc = np.column_stack([luma, SHOWN_MODULE * np.cos(radians), SHOWN_MODULE * np.sin(radians)])
    wheel: Bytes = np.clip(bgr_from_ycc(ycc), 0.0, GREY_LEVELS).astype(np.uint8)
    return wheel


def _hsv_wheel() -> Bytes:
    """The color of each hue of HSV, shape (256, 3)."""
    sextants = np.arange(TURN)[:, None] * (6.0 / TURN) - np.array([4.0, 2.0, 0.0])
    away = np.abs((sextants + 3.0) % 6.0 - 3.0)
    wheel: Bytes = (np.clip(2.0 - away, 0.0, 1.0) * GREY_LEVELS).astype(np.uint8)
    return wheel


def _colored(angle: Bytes, valid: np.ndarray, wheel: Bytes) -> Bytes:
    """Angles as the colors that have them; dark where they are not valid."""
    shown: Bytes = np.where(valid[..., None], wheel[angle], DARK)
    return shown


def _grey(levels: np.ndarray) -> Bytes:
    return np.repeat(levels.astype(np.uint8)[..., None], 3, axis=2)
