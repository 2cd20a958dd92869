"""Light: converts pictures to the light in which the venue's colors were measured.

A camera is linear in its light (measured: the same robots under lamps and by two windows alone differ by one gain per
channel, correlation 0.99, once the sensor's black level is subtracted). So one gain per channel corrects for dimmer,
brighter and differently colored light. The light is measured on what the field always shows: the carpet's median
colors, or on a black field, which reflects almost nothing, the lines and walls.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vision_core.clock import NS_PER_S, Instant
from vision_core.geometry import Bytes, PixelPlaces, frozen
from vision_core.models.camera import CameraModel
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent
from vision_core.native.kernels import kernel, read_only
from vision_core.settings.schema import FieldSettings, LightSettings, Settings
from vision_core.types.colors import Levels, Light
from vision_core.types.reasons import Reason

SAMPLES_PER_SIDE = 64
"""Points of the sampling grid along each axis of the field."""
MIN_SAMPLES = 256
"""Samples that must lie in the picture to measure the light."""
MIN_SIGNAL = 4.0
"""Grey levels above black that are needed: below, rounding alone moves a gain by more than an eighth."""
SATURATED = 254
"""From this level on a channel is saturated: it may be any amount brighter."""
MAX_SATURATED = 0.25
"""Share of the samples that may be saturated."""
BRIGHTNESS_LEVELS = 3 * 256
"""Of blue + green + red."""
FIXED_BITS = 8
FIXED_ONE = 1 << FIXED_BITS
"""1 in the fixed-point numbers of ``relight``."""
MEASURE_EVERY_NS = NS_PER_S
MIN_GAIN_CHANGE = 0.05
"""Smaller changes of a gain's logarithm are ignored: lamps flicker by so much, and no color class is so narrow."""
NO_GAINS: Levels = (1.0, 1.0, 1.0)
NEUTRAL_LIGHT = Light((0.0, 0.0, 0.0), NO_GAINS)
"""Leaves pictures as they are."""


def field_samples(camera: CameraModel, field: FieldSettings, size_px: tuple[int, int], margin_m: float) -> PixelPlaces:
    """Pixels of a grid over the field inside its walls or limits, those in the picture only.

    size_px: width and height of the picture; margin_m: how far beyond the limits the grid reaches.
    """
    half_x, half_y = (max(half + margin_m, 0.0) for half in accepted_half_extent(field))
    steps = (np.arange(SAMPLES_PER_SIDE) + 0.5) / SAMPLES_PER_SIDE * 2.0 - 1.0
    along, across = np.meshgrid(steps * half_x, steps * half_y)
    pixels = camera.pixel_from_field(np.column_stack([along.ravel(), across.ravel()]))
    with np.errstate(invalid="ignore"):
        inside = ((pixels >= 0.0) & (pixels <= np.array(size_px) - 1.0)).all(axis=1)
    return frozen(pixels[inside].round().astype(np.int32))


def reference_of(pixels: Bytes, samples: PixelPlaces, band: Sequence[float]) -> tuple[Levels, float]:
    """Mean color of the samples in a band of brightness, and the share of them that is saturated.

    pixels: shape (height, width, 3); band: from and to, as shares of the samples from the darkest (0) to the brightest
    (1). Returns blue green red [grey levels], nan without samples, and the share with a saturated channel.
    """
    sums = np.zeros((BRIGHTNESS_LEVELS, 5), dtype=np.int64)
    sums_by_level(read_only(pixels), read_only(samples), sums)
    # how much of each brightness level lies in the band
    counts = sums[:, 0]
    below = counts.cumsum() - counts
    low, high = band[0] * counts.sum(), max(band[1] * counts.sum(), band[0] * counts.sum() + 1.0)
    taken = np.clip(np.minimum(below + counts, high) - np.maximum(below, low), 0.0, None)
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = np.where(counts > 0, taken / counts, 0.0)
        blue, green, red, saturated = (shares @ sums[:, 1:] / taken.sum()).tolist()
    return (blue, green, red), saturated


def light_of(pixels: Bytes, samples: PixelPlaces, settings: LightSettings) -> Light:
    """The light of a picture: that of the set-up when there is no reference.

    Where it cannot be measured the gains are those of the set-up and the reason says why. pixels: shape (height, width,
    3), blue green red; samples: of ``field_samples``.
    """
    black, start = settings.black_bgr, start_light(settings)
    if settings.reference_bgr is None:
        return start
    if len(samples) < MIN_SAMPLES:
        few = f"only {len(samples)} of {SAMPLES_PER_SIDE**2} samples of the field lie in the picture"
        return _unknown(start, few, "Correct the camera's position or the field's measures.")
    found, saturated = reference_of(pixels, samples, settings.band)
    signal = [level - dark for level, dark in zip(found, black, strict=True)]
    if saturated > MAX_SATURATED:
        bright = f"over-exposed: {saturated:.0%} of the samples of the field are saturated"
        return _unknown(start, bright, "Close the lens, or lower the camera's exposure or gain.")
    if min(signal) < MIN_SIGNAL:
        dark = f"too dark: the samples of the field are {min(signal):.1f} grey levels above black"
        return _unknown(start, dark, "Switch on more lamps, open the lens, or let the camera expose longer.")
    blue, green, red = (wanted / level for wanted, level in zip(settings.reference_bgr, signal, strict=True))
    if not settings.white_balance:
        blue = green = red = (blue * green * red) ** (1.0 / 3.0)
    limit = settings.max_gain
    if not 1.0 / limit <= min(blue, green, red) <= max(blue, green, red) <= limit:
        gains = f"{blue:.2f} {green:.2f} {red:.2f}"
        needed = f"it needs the gains {gains} (colors.light.max_gain accepts {1.0 / limit:g} to {limit:g})"
        return _unknown(start, needed, "Measure colors.light again with `pslv colors light`.")
    return Light(black, (blue, green, red))


class Relighter:
    """Converts pictures of one size to the venue's light, in memory that is allocated once."""

    def __init__(self, width_px: int, height_px: int) -> None:
        self.shape = (height_px, width_px, 3)
        self._lit = np.empty(self.shape, dtype=np.uint8)
        self._gains = np.empty(3 * width_px, dtype=np.int32)
        self._offsets = np.empty(3 * width_px, dtype=np.int32)
        self._light = NEUTRAL_LIGHT

    def relit(self, pixels: Bytes, light: Light) -> Bytes:
        """(pixel - black) * gain, clamped to 0..253; saturated channels stay. A neutral light: the picture itself.

        pixels: shape (height, width, 3). The next call overwrites the result.
        """
        if light.neutral:
            return pixels
        if light is not self._light:
            gain, black = np.array(light.gain_bgr), np.array(light.black_bgr)
            self._gains.reshape(-1, 3)[:] = (gain * FIXED_ONE).round()
            self._offsets.reshape(-1, 3)[:] = ((0.5 - gain * black) * FIXED_ONE).round()
            self._light = light
        rows = len(pixels), -1
        relight(read_only(pixels).reshape(rows), self._gains, self._offsets, self._lit.reshape(rows))
        return self._lit


class Lighting:
    """Measures the light of a camera's pictures once in a while, and converts them to the venue's light.

    So one color table is right in every light, and the later stages see no difference. Making a new table instead would
    cost a picture nothing, but near black its cells of 8 levels are too coarse: of pale markers at a gain of 2 it loses
    more than half of the pixels.
    """

    def __init__(self, settings: Settings, camera: CameraSetup) -> None:
        self._settings = settings.colors.light
        self._samples = field_samples(camera.model, settings.field, camera.size_px, self._settings.margin_m)
        self._relighter = Relighter(*camera.size_px)
        self._measured: Instant | None = None
        self._held = False
        self.light = start_light(self._settings)
        """Of the last picture."""

    def warm_up(self) -> None:
        """Load or compile the kernels, and forget what was measured."""
        dark = np.zeros(self._relighter.shape, dtype=np.uint8)
        light_of(dark, self._samples, self._settings)
        self._relighter.relit(dark, Light((1.0, 1.0, 1.0), NO_GAINS))
        self._measured, self.light = None, start_light(self._settings)

    def hold(self, light: Light) -> None:
        """Convert the next pictures from a light that somebody else measures: the task ``follow`` of the service."""
        self._held, self.light = True, light

    def lit(self, pixels: Bytes, at: Instant) -> Bytes:
        """A picture in the venue's light, shape (height, width, 3). The next call overwrites it.

        The light is measured once in MEASURE_EVERY_NS, and at once when a picture is not later than the last one: then
        it does not belong to the same sequence.
        """
        is_due = self._measured is None or not 0 < at - self._measured < MEASURE_EVERY_NS
        if self._settings.adapt and is_due and not self._held:
            fresh = self._measured is None or at <= self._measured
            self._measured = at
            last = start_light(self._settings) if fresh else self.light
            self.light = settled(last, self.measure(pixels), self._settings)
        return self.relit(pixels)

    def relit(self, pixels: Bytes) -> Bytes:
        """The last picture in the venue's light once more; nothing is measured."""
        return self._relighter.relit(pixels, self.light)

    def measure(self, pixels: Bytes) -> Light:
        """The light of a picture, shape (height, width, 3), as ``light_of``."""
        return light_of(pixels, self._samples, self._settings)


def start_light(settings: LightSettings) -> Light:
    """The light of the set-up, as its own pictures are converted."""
    return Light(settings.black_bgr, settings.gain_bgr)


def settled(last: Light, now: Light, settings: LightSettings) -> Light:
    """The light to use after the last one: a new one that clearly differs, that of the set-up when it is near that."""
    if now.reason:
        return replace(last, reason=now.reason)
    if gain_distance(now, last) <= MIN_GAIN_CHANGE:
        return last if last.reason is None else replace(last, reason=None)
    start = start_light(settings)
    return start if gain_distance(now, start) <= settings.dead_band else now


def gain_distance(one: Light, other: Light) -> float:
    """The largest difference of two lights' gains, as a logarithm."""
    return max(abs(math.log(new / old)) for new, old in zip(one.gain_bgr, other.gain_bgr, strict=True))


def _unknown(start: Light, why: str, advice: str) -> Light:
    return replace(start, reason=Reason(f"light: {why}", advice))


@kernel
def sums_by_level(pixels: Bytes, samples: PixelPlaces, sums: np.ndarray) -> None:
    """Sum up samples by their brightness b + g + r: sums, shape (768, 5), columns count, b, g, r, saturated."""
    for index in range(len(samples)):
        pixel = pixels[samples[index, 1], samples[index, 0]]
        blue, green, red = np.int64(pixel[0]), np.int64(pixel[1]), np.int64(pixel[2])
        row = sums[blue + green + red]
        row[0] += 1
        row[1] += blue
        row[2] += green
        row[3] += red
        if max(blue, green, red) >= SATURATED:
            row[4] += 1


@kernel
def relight(pixels: Bytes, gains: np.ndarray, offsets: np.ndarray, out: Bytes) -> None:
    """out = pixels * gains + offsets, clamped, in fixed point.

    pixels, out: shape (height, 3 * width); gains, offsets: repeated per pixel, shape (3 * width,). A saturated channel
    stays as it is: its true level is not known, and yellow must not turn green. No other channel becomes saturated, so
    that later stages can tell. 32-bit arithmetic without branches, because the compiler makes vector instructions of
    it, unlike of a table with 256 entries.
    """
    for y in range(len(pixels)):
        row, lit = pixels[y], out[y]
        for i in range(len(row)):
            level = np.int32(row[i])
            value = np.int32(np.int32(np.int32(level * gains[i]) + offsets[i]) >> np.int32(FIXED_BITS))
            value = min(max(value, np.int32(0)), np.int32(SATURATED - 1))
            lit[i] = np.uint8(level if level >= np.int32(SATURATED) else value)
