"""Light: a picture in other light is what the venue's light would have shown, or the light says why not."""

from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vision_core.clock import NS_PER_S, Instant
from vision_core.color.light import (
    NO_GAINS,
    SAMPLES_PER_SIDE,
    Lighting,
    Relighter,
    field_samples,
    light_of,
    reference_of,
    relight,
    settled,
    sums_by_level,
)
from vision_core.color.settling import SettlingLight
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import LightSettings
from vision_core.types.colors import Light
from vision_core.types.reasons import Reason
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
SETUP = CameraSetup.from_settings(SETTINGS)
CAMERA = SETUP.model
SIZE = SETTINGS.camera.width_px, SETTINGS.camera.height_px
SAMPLES = field_samples(CAMERA, SETTINGS.field, SIZE, 0.0)
CARPET = np.array([70.0, 120.0, 60.0])
ADAPT = LightSettings(
    adapt=True,
    black_bgr=(12.0, 14.0, 13.0),
    band=(0.25, 0.75),
    reference_bgr=(70.0, 120.0, 60.0),
    white_balance=True,
    margin_m=0.0,
    gain_bgr=NO_GAINS,
    dead_band=0.1,
    max_gain=8.0,
    max_shift=1.5,
)


def scene(gain: tuple[float, float, float] = (1.0, 1.0, 1.0), seed: int = 1) -> Bytes:
    """A carpet with noise and a few white things, in a light that makes up for gains."""
    rng = np.random.default_rng(seed)
    bgr = np.tile(CARPET, (SIZE[1], SIZE[0], 1))
    bgr[200:230, 100:400] = 170.0
    seen = bgr / np.array(gain) + np.array(ADAPT.black_bgr) + rng.normal(0.0, 2.0, bgr.shape)
    picture: Bytes = np.clip(seen.round(), 0, 255).astype(np.uint8)
    return picture


def lighting(light: LightSettings = ADAPT) -> Lighting:
    colors = msgspec.structs.replace(SETTINGS.colors, light=light)
    return Lighting(msgspec.structs.replace(SETTINGS, colors=colors), SETUP)


def test_samples_lie_on_the_field_and_in_the_picture() -> None:
    assert len(SAMPLES) == SAMPLES_PER_SIDE**2
    assert (SAMPLES >= 0).all()
    assert (np.array(SIZE) > SAMPLES).all()
    points = CAMERA.field_from_pixel(SAMPLES.astype(np.float64))
    half_length = SETTINGS.field.length_m / 2.0 + SETTINGS.field.margin_m
    assert np.abs(points[:, 0]).max() <= half_length + 0.01


@settings(deadline=None, max_examples=20)
@given(st.tuples(*[st.floats(0.6, 6.0)] * 3))
def test_the_gains_of_a_known_light_are_found(gain: tuple[float, float, float]) -> None:
    light = light_of(scene(gain), SAMPLES, ADAPT)
    assert light.reason is None
    assert light.gain_bgr == pytest.approx(gain, rel=0.03)
    assert light.black_bgr == ADAPT.black_bgr


def test_one_gain_for_all_channels_keeps_their_relation() -> None:
    together = msgspec.structs.replace(ADAPT, white_balance=False)
    blue, green, red = light_of(scene((2.0, 2.0, 2.0)), SAMPLES, together).gain_bgr
    assert blue == green == red == pytest.approx(2.0, rel=0.03)


def test_a_band_takes_the_bright_things_of_a_dark_field() -> None:
    share = ((SAMPLES[:, 1] >= 200) & (SAMPLES[:, 1] < 230) & (SAMPLES[:, 0] >= 100) & (SAMPLES[:, 0] < 400)).mean()
    found, white = reference_of(scene(), SAMPLES, (1.0 - share * 0.9, 1.0))
    assert np.array(found) - ADAPT.black_bgr == pytest.approx([170.0] * 3, abs=1.0)
    assert white == 0.0


@settings(deadline=None, max_examples=20)
@given(st.floats(0.0, 0.9), st.floats(0.01, 0.1), st.integers(0, 99))
def test_the_band_is_a_mean_of_sorted_samples(low: float, width: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    grey = rng.integers(0, 254, SIZE[::-1], dtype=np.uint8)
    found, _ = reference_of(np.repeat(grey[..., None], 3, axis=2), SAMPLES, (low, low + width))
    values = np.sort(grey[SAMPLES[:, 1], SAMPLES[:, 0]])
    first, last = int(low * len(values)), int((low + width) * len(values))
    assert found[0] == pytest.approx(values[first : last + 1].mean(), abs=0.6)


@pytest.mark.parametrize(
    ("picture", "word"),
    [(np.zeros_like(scene()), "too dark"), (np.full_like(scene(), 255), "over-exposed")],
)
def test_what_cannot_be_judged_says_why_and_changes_nothing(picture: Bytes, word: str) -> None:
    light = light_of(picture, SAMPLES, ADAPT)
    assert word in str(light.reason)
    assert light.gain_bgr == (1.0, 1.0, 1.0)


def test_too_few_samples_in_the_picture_are_named() -> None:
    assert "100 of 4096 samples" in str(light_of(scene(), SAMPLES[:100], ADAPT).reason)
    assert "0 of 4096" in str(light_of(scene(), SAMPLES[:0], ADAPT).reason)


@settings(deadline=None)
@given(st.tuples(*[st.floats(0.1, 8.0)] * 3), st.tuples(*[st.floats(0.0, 40.0)] * 3), st.integers(0, 9))
def test_relit_is_the_formula(gain: tuple[float, float, float], black: tuple[float, float, float], seed: int) -> None:
    pixels = np.random.default_rng(seed).integers(0, 256, (6, 10, 3), dtype=np.uint8)
    lit = Relighter(10, 6).relit(pixels, Light(black, gain)).astype(np.int64)
    exact = np.clip((pixels - np.array(black)) * np.array(gain), 0.0, 253.0)  # nothing becomes saturated
    below_white = pixels < 254
    assert np.abs(lit - exact)[below_white].max() <= 1.1
    assert (lit == pixels)[~below_white].all()


def test_the_venues_own_light_costs_nothing() -> None:
    pixels = scene()
    assert Relighter(*SIZE).relit(pixels, Light((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))) is pixels
    plain = msgspec.structs.replace(ADAPT, black_bgr=(0.0, 0.0, 0.0))
    assert lighting(msgspec.structs.replace(plain, adapt=False)).lit(pixels, Instant(0)) is pixels
    near = msgspec.structs.replace(plain, reference_bgr=(87.0, 129.0, 77.0))  # over black, and a little off
    assert lighting(near).lit(pixels, Instant(0)) is pixels
    assert lighting(msgspec.structs.replace(near, dead_band=0.0)).lit(pixels, Instant(0)) is not pixels


def test_without_a_reference_pictures_stay_in_the_light_of_the_set_up() -> None:
    alone = msgspec.structs.replace(ADAPT, reference_bgr=None, gain_bgr=(2.0, 2.0, 2.0))
    assert light_of(scene((3.0, 3.0, 3.0)), SAMPLES, alone) == Light(alone.black_bgr, alone.gain_bgr)


def test_a_light_beyond_the_bounds_is_reported_and_not_followed() -> None:
    bounded = msgspec.structs.replace(ADAPT, max_gain=2.0)
    light = light_of(scene((3.0, 3.0, 3.0)), SAMPLES, bounded)
    assert light.gain_bgr == NO_GAINS
    assert "accepts 0.5 to 2" in str(light.reason)


def test_a_dim_picture_looks_as_in_the_venues_light() -> None:
    lit = lighting().lit(scene((3.0, 2.0, 2.5)), Instant(0))
    assert np.median(lit[300:], axis=(0, 1)) == pytest.approx(CARPET, abs=2.0)
    assert np.median(lit[205:225, 110:390], axis=(0, 1)) == pytest.approx([170.0] * 3, abs=4.0)


def test_light_is_judged_once_a_second_and_for_every_still() -> None:
    eyes = lighting()
    eyes.lit(scene(), Instant(1))
    before = eyes.light
    eyes.lit(scene((2.0, 2.0, 2.0)), Instant(NS_PER_S))
    assert eyes.light is before
    eyes.lit(scene((2.0, 2.0, 2.0)), Instant(NS_PER_S + 1))
    assert eyes.light.gain_bgr[0] == pytest.approx(2.0, rel=0.03)
    eyes.lit(scene(), Instant(NS_PER_S + 1))
    assert eyes.light.gain_bgr[0] == pytest.approx(1.0, rel=0.03)


def test_a_flicker_moves_nothing_and_a_covered_lens_keeps_the_last_gains() -> None:
    black = ADAPT.black_bgr
    last = Light(black, (2.0, 2.0, 2.0))
    assert settled(last, Light(black, (2.02, 2.0, 1.99)), ADAPT) is last
    moved = Light(black, (2.2, 2.0, 2.0))
    assert settled(last, moved, ADAPT) is moved
    dark = Reason("light: too dark", "Switch on lamps.")
    covered = settled(last, Light(black, NO_GAINS, dark), ADAPT)
    assert covered == Light(black, (2.0, 2.0, 2.0), dark)
    assert settled(covered, last, ADAPT) == last
    assert settled(last, Light(black, (1.05, 1.0, 0.95)), ADAPT) == Light(black, NO_GAINS)


def test_a_light_is_followed_when_three_looks_agree() -> None:
    colors = msgspec.structs.replace(SETTINGS.colors, light=ADAPT)
    eyes = SettlingLight(msgspec.structs.replace(SETTINGS, colors=colors), SETUP)
    own, dim, dimmer = scene(), scene((2.0, 2.0, 2.0)), scene((3.0, 3.0, 3.0))
    assert eyes.look(own)
    start = eyes.light
    assert [eyes.look(pixels) for pixels in (dim, dim, dimmer, dimmer, dim, dim)] == [False] * 6
    assert eyes.light is start
    assert eyes.look(dim)
    assert eyes.light.gain_bgr == pytest.approx((2.0, 2.0, 2.0), rel=0.03)
    for _ in range(3):
        eyes.look(np.zeros_like(own))
    assert eyes.light.reason is not None
    assert eyes.light.gain_bgr == pytest.approx((2.0, 2.0, 2.0), rel=0.03)
    for _ in range(3):
        eyes.look(own)
    assert eyes.light.gain_bgr == NO_GAINS
    for _ in range(3):
        eyes.look(dim)
    eyes.refuse()
    assert [eyes.look(dim) for _ in range(4)] == [True] * 4
    assert eyes.light.gain_bgr == NO_GAINS
    eyes.reconsider()
    eyes.look(dim)
    assert eyes.light.gain_bgr != NO_GAINS
    eyes.reset()
    assert eyes.light == start
    assert eyes.look(dim)  # a service that starts in another light does not wait
    assert eyes.light.gain_bgr != start.gain_bgr


def test_each_kernel_is_compiled_once() -> None:
    eyes = lighting()
    eyes.warm_up()
    writable, fixed = scene(), scene()
    fixed.setflags(write=False)
    for pixels in (writable, fixed):
        eyes.lit(pixels, Instant(0))
    kernels: list[Any] = [relight, sums_by_level]
    assert [len(kernel.signatures) for kernel in kernels] == [1, 1]
