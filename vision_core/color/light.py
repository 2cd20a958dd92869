"""Light: what a picture would look like in the light that the colors were tuned in.

A camera is linear in its light (measured: the same robots under lamps and by two windows alone differ by one gain
per channel, correlation 0.99, once the sensor's black level is subtracted). So one gain per channel makes up for
dimmer, brighter and otherwise colored light, and the thing to judge it by is whatever the field always shows:
the carpet's median colors, or on a black field, which returns next to nothing, the lines and walls.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vision_core.clock import NS_PER_S, Instant
from vision_core.geometry import Bytes, frozen
from vision_core.models.camera import CameraModel
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent
from vision_core.native.kernels import kernel, read_only
from vision_core.settings.schema import FieldSettings, LightSettings, Settings
from vision_core.types.colors import Levels, Light

Points = NDArray[np.int32]

SAMPLES_PER_SIDE = 64
MIN_SAMPLES = 256
MIN_SIGNAL = 4.0
"""Grey levels over black: below, rounding alone moves a gain by more than an eighth."""
MAX_GAIN = 32.0
WHITE = 254
"""From here on a channel tells nothing any more."""
MAX_WHITE = 0.25
LEVELS = 3 * 256
FIXED_BITS = 8
SCALE = 1 << FIXED_BITS
JUDGE_EVERY = NS_PER_S
STEADY = 0.03
"""Logarithm of a gain: lamps flicker by less, and no color class is so narrow."""
AS_IT_IS = Light((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


def field_samples(camera: CameraModel, field: FieldSettings, size_px: tuple[int, int], margin_m: float) -> Points:
    """Pixels spread over the field inside its walls or limits: x, y, shape (n, 2); those in the picture only."""
    half_x, half_y = (max(half + margin_m, 0.0) for half in accepted_half_extent(field))
    steps = (np.arange(SAMPLES_PER_SIDE) + 0.5) / SAMPLES_PER_SIDE * 2.0 - 1.0
    along, across = np.meshgrid(steps * half_x, steps * half_y)
    pixels = camera.pixel_from_field(np.column_stack([along.ravel(), across.ravel()]))
    with np.errstate(invalid="ignore"):
        inside = ((pixels >= 0.0) & (pixels <= np.array(size_px) - 1.0)).all(axis=1)
    return frozen(pixels[inside].round().astype(np.int32))


def reference_of(pixels: Bytes, samples: Points, band: Sequence[float]) -> tuple[Levels, float]:
    """Mean color of the samples in a band between the darkest (0) and the brightest (1), and how many are white.

    pixels: shape (height, width, 3); returns blue green red [grey levels], not a number without samples, and the
    share of the band in which a channel is at its end.
    """
    sums = np.zeros((LEVELS, 5), dtype=np.int64)
    sums_by_level(read_only(pixels), read_only(samples), sums)
    counts = sums[:, 0]
    below = counts.cumsum() - counts
    low, high = band[0] * counts.sum(), max(band[1] * counts.sum(), band[0] * counts.sum() + 1.0)
    taken = np.clip(np.minimum(below + counts, high) - np.maximum(below, low), 0.0, None)
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = np.where(counts > 0, taken / counts, 0.0)
        blue, green, red, white = (shares @ sums[:, 1:] / taken.sum()).tolist()
    return (blue, green, red), white


def light_of(pixels: Bytes, samples: Points, settings: LightSettings) -> Light:
    """The light of a picture. Where it cannot be judged the light says why and its gains are 1.

    pixels: shape (height, width, 3), blue green red; samples: of ``field_samples``.
    """
    black = settings.black_bgr
    if len(samples) < MIN_SAMPLES:
        return _unknown(black, f"only {len(samples)} of {SAMPLES_PER_SIDE**2} samples of the field lie in the picture")
    found, white = reference_of(pixels, samples, settings.band)
    signal = [level - dark for level, dark in zip(found, black, strict=True)]
    if white > MAX_WHITE:
        return _unknown(black, f"over-exposed: {white:.0%} of what the light is judged by is at the sensor's end")
    if min(signal) < MIN_SIGNAL:
        return _unknown(black, f"too dark: what the light is judged by is {min(signal):.1f} grey levels over black")
    blue, green, red = (wanted / level for wanted, level in zip(settings.reference_bgr, signal, strict=True))
    if not settings.white_balance:
        blue = green = red = (blue * green * red) ** (1.0 / 3.0)
    if not 1.0 / MAX_GAIN <= min(blue, green, red) <= max(blue, green, red) <= MAX_GAIN:
        gains = f"{blue:.2f} {green:.2f} {red:.2f}"
        return _unknown(black, f"gains of {gains}, not {1.0 / MAX_GAIN:g} to {MAX_GAIN:g}: see colors.light")
    return Light(black, (blue, green, red))


class Relighter:
    """Shows pictures of one size in the venue's light, in memory that is taken once."""

    def __init__(self, width_px: int, height_px: int) -> None:
        self.shape = (height_px, width_px, 3)
        self._lit = np.empty(self.shape, dtype=np.uint8)
        self._gains = np.empty(3 * width_px, dtype=np.int32)
        self._offsets = np.empty(3 * width_px, dtype=np.int32)
        self._light = AS_IT_IS

    def relit(self, pixels: Bytes, light: Light) -> Bytes:
        """A picture as (pixel - black) * gain, 0..255; itself when the light leaves it as it is.

        pixels: shape (height, width, 3); what is returned is overwritten by the next call.
        """
        if light.neutral:
            return pixels
        if light is not self._light:
            gain, black = np.array(light.gain_bgr), np.array(light.black_bgr)
            self._gains.reshape(-1, 3)[:] = (gain * SCALE).round()
            self._offsets.reshape(-1, 3)[:] = ((0.5 - gain * black) * SCALE).round()
            self._light = light
        rows = len(pixels), -1
        relight(read_only(pixels).reshape(rows), self._gains, self._offsets, self._lit.reshape(rows))
        return self._lit


class Lighting:
    """Judges the light of a camera's pictures once in a while, and shows them in the venue's light.

    One table of colors then serves in every light, and nothing that follows need know of it. Making the table anew
    instead would cost a picture nothing, but near black its cells of 8 levels are too coarse: of pale markers at a
    gain of 2 it loses more than half of the pixels.
    """

    def __init__(self, settings: Settings, camera: CameraSetup) -> None:
        self._settings = settings.colors.light
        self._samples = field_samples(camera.model, settings.field, camera.size_px, self._settings.margin_m)
        self._relighter = Relighter(*camera.size_px)
        self._judged: Instant | None = None
        self.light = AS_IT_IS
        """That of the picture shown last."""

    def warm_up(self) -> None:
        """Load or compile the kernels, and forget what was judged."""
        dark = np.zeros(self._relighter.shape, dtype=np.uint8)
        light_of(dark, self._samples, self._settings)
        self._relighter.relit(dark, Light((1.0, 1.0, 1.0), (1.0, 1.0, 1.0)))
        self._judged, self.light = None, AS_IT_IS

    def lit(self, pixels: Bytes, at: Instant) -> Bytes:
        """A picture in the venue's light: shape (height, width, 3); overwritten by the next call.

        The light is judged once in JUDGE_EVERY, and anew when a picture is no later than the last: it is another one.
        """
        if not self._settings.adapt:
            return pixels
        if self._judged is None or at <= self._judged or at - self._judged >= JUDGE_EVERY:
            fresh = self._judged is None or at <= self._judged
            self._judged = at
            self.light = settled(self.light, light_of(pixels, self._samples, self._settings), fresh=fresh)
        return self._relighter.relit(pixels, self.light)


def settled(last: Light, now: Light, *, fresh: bool) -> Light:
    """The light to use: the last one while nothing moved by more than STEADY, or when this picture tells none."""
    if fresh:
        return now
    if now.reason:
        return replace(last, reason=now.reason)
    moved = max(abs(math.log(new / old)) for new, old in zip(now.gain_bgr, last.gain_bgr, strict=True))
    return now if last.reason or moved > STEADY else last


def _unknown(black: Levels, reason: str) -> Light:
    return Light(black, (1.0, 1.0, 1.0), f"light: {reason}")


@kernel
def sums_by_level(pixels: Bytes, samples: Points, sums: np.ndarray) -> None:
    """Sum samples by their brightness b + g + r: sums, shape (768, 5), columns count, b, g, r, white."""
    for index in range(len(samples)):
        pixel = pixels[samples[index, 1], samples[index, 0]]
        blue, green, red = np.int64(pixel[0]), np.int64(pixel[1]), np.int64(pixel[2])
        row = sums[blue + green + red]
        row[0] += 1
        row[1] += blue
        row[2] += green
        row[3] += red
        if max(blue, green, red) >= WHITE:
            row[4] += 1


@kernel
def relight(pixels: Bytes, gains: np.ndarray, offsets: np.ndarray, out: Bytes) -> None:
    """out = pixels * gains + offsets, clamped: rows of shape (height, 3 * width), gains and offsets repeated per pixel.

    A channel at its end stays there: how much more it would have been nobody knows, and yellow must not turn green.
    Arithmetic in 32 bits without branches: the compiler makes vector instructions of it, a table of 256 it cannot.
    """
    for y in range(len(pixels)):
        row, lit = pixels[y], out[y]
        for i in range(len(row)):
            level = np.int32(row[i])
            value = np.int32(np.int32(np.int32(level * gains[i]) + offsets[i]) >> np.int32(FIXED_BITS))
            value = min(max(value, np.int32(0)), np.int32(255))
            lit[i] = np.uint8(level if level >= np.int32(WHITE) else value)
