"""Faults of a source: what each does to a picture, and that a source has them from the next image on."""

import msgspec
import numpy as np

from vision_core.capture.faults import NO_LIGHT_FAULT, FaultySource, changed_light
from vision_core.clock import Instant
from vision_core.geometry import Bytes
from vision_core.settings.schema import FaultSettings, LightFaultSettings
from vision_core.timing.rate_keeper import Keeper, RequestedKeeper
from vision_core.venues.loader import load_settings

GREY = np.full((10, 40, 3), 100, dtype=np.uint8)


class GreySource:
    """Shows a grey picture."""

    description, repeats, rate_hz = "grey", True, 30.0

    def __init__(self) -> None:
        self.keeper: Keeper = RequestedKeeper(30.0)
        self.was_closed = False

    def prepare(self) -> None: ...

    def grab(self, pixels: Bytes) -> Instant:
        pixels[:] = GREY
        return Instant(7)

    def close(self) -> None:
        self.was_closed = True


def fault(**values: object) -> LightFaultSettings:
    return msgspec.structs.replace(NO_LIGHT_FAULT, **values)


def test_the_settings_have_no_fault() -> None:
    assert load_settings().faults == FaultSettings(light=NO_LIGHT_FAULT)


def test_gains_black_level_and_curve() -> None:
    assert changed_light(fault(gain_bgr=(0.5, 1.0, 4.0), black=20.0))(GREY)[0, 0].tolist() == [70, 120, 255]
    ends = np.array([[[0, 0, 0], [255, 255, 255], [100, 100, 100]]], dtype=np.uint8)
    assert changed_light(fault(gamma=1.4))(ends)[0, :, 0].tolist() == [0, 255, 69]


def test_the_right_half_is_dark() -> None:
    assert changed_light(fault(right_half=0.5))(GREY)[0, [0, -1], 0].tolist() == [100, 50]


def test_noise_has_its_deviation_and_differs_from_picture_to_picture() -> None:
    change = changed_light(fault(noise=8.0))
    whole = np.full((100, 100, 3), 100, dtype=np.uint8)
    one, other = change(whole), change(whole)
    assert 7.5 < one.std() < 8.5
    assert not np.array_equal(one, other)


def test_a_source_has_its_faults_from_the_next_image_on() -> None:
    source = GreySource()
    faulty = FaultySource(source, FaultSettings(light=NO_LIGHT_FAULT))
    pixels = np.zeros_like(GREY)
    assert faulty.grab(pixels) == 7
    assert (pixels == 100).all()
    faulty.have(FaultSettings(light=fault(gain_bgr=(0.5, 0.5, 0.5))))
    faulty.grab(pixels)
    assert (pixels == 50).all()
    faulty.have(FaultSettings(light=NO_LIGHT_FAULT))
    faulty.grab(pixels)
    assert (pixels == 100).all()
    faulty.keeper = RequestedKeeper(60.0)
    assert source.keeper is faulty.keeper
    faulty.close()
    assert source.was_closed
