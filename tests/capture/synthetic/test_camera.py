"""The simulated camera as a source: deterministic, timed, and clear about what it cannot render."""

import numpy as np
import pytest

from tests.capture.synthetic.scenes import plain_settings
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import NS_PER_S, Instant, ManualClock
from vision_core.errors import SettingsError, SourceError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import Settings
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow  # renders whole pictures


def frames(settings: Settings, count: int) -> tuple[SyntheticCamera, list[Bytes], list[Instant]]:
    camera = SyntheticCamera(settings, CameraSetup.from_settings(settings), ManualClock(Instant(100)), paced=False)
    images, instants = [], []
    for _ in range(count):
        pixels = CameraSetup.from_settings(settings).black_image()
        instants.append(camera.grab(pixels))
        images.append(pixels)
    return camera, images, instants


def test_a_seed_gives_the_same_images_and_truth_bit_by_bit() -> None:
    one, images, _ = frames(load_settings(), 12)
    again, same_images, _ = frames(load_settings(), 12)
    other, other_images, _ = frames(load_settings(options={"synthetic.seed": 2}), 12)
    assert all(np.array_equal(a, b) for a, b in zip(images, same_images, strict=True))
    assert one.truth == again.truth
    assert one.truth != other.truth
    assert not np.array_equal(images[-1], other_images[-1])
    assert not np.array_equal(images[0], images[-1])


def test_instants_are_those_of_the_rate_and_of_the_truth() -> None:
    camera, _, instants = frames(load_settings(), 4)
    assert instants == [100 + round(k * NS_PER_S / 30.0) for k in range(4)]
    assert camera.truth.instant == instants[-1]


def test_the_truth_is_what_the_image_shows() -> None:
    """The center dot of every robot lies at its true place: team blue is blue there, team yellow yellow."""
    settings = plain_settings(synthetic__robots_per_team=8, match__numbers=8)
    camera, images, _ = frames(settings, 30)
    truth = camera.truth
    seen = [robot for robot in truth.robots if robot.in_picture]
    assert len(seen) >= 12
    for robot in seen:
        place = np.array([[robot.x_m, robot.y_m]])
        u, v = (
            CameraSetup.from_settings(settings)
            .model.pixel_from_field(place, settings.robots.height_m)[0]
            .round()
            .astype(int)
        )
        blue, _, red = images[-1][v, u].astype(int)
        assert (blue - red > 100) if robot.team == "blue" else (red - blue > 100)


def test_truth_comes_after_an_image_only() -> None:
    with pytest.raises(SourceError, match="grab"):
        _ = SyntheticCamera(
            load_settings(), CameraSetup.from_settings(load_settings()), ManualClock(), paced=False
        ).truth


def test_a_camera_without_a_lens_is_refused() -> None:
    venue = load_settings(venue="ssl-rosenheim")
    with pytest.raises(SourceError, match="pinhole"):
        SyntheticCamera(venue, CameraSetup.from_settings(venue), ManualClock(), paced=False)


def test_an_id_that_the_pattern_lacks_is_refused() -> None:
    ids = [1, 2, 77, 4, 5]
    with pytest.raises((SourceError, SettingsError), match="77"):
        frames(load_settings(options={"match.blue_ids": ids}), 1)


@pytest.mark.parametrize(("width", "height", "rate_hz"), [(160, 120, 60.0), (1280, 1024, 5.0)])
def test_any_resolution_and_rate(width: int, height: int, rate_hz: float) -> None:
    settings = load_settings(
        options={
            "camera.width_px": width,
            "camera.height_px": height,
            "camera.rate_hz": rate_hz,
            "camera.pinhole.focal_px": 700.0 * width / 640.0,
            "camera.pinhole.center_px": [width / 2.0, height / 2.0],
        }
    )
    camera, images, _ = frames(settings, 2)
    assert camera.rate_hz == rate_hz
    assert images[0].std() > 20
