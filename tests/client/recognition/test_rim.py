"""The mirror is found in the picture: whole, cut, covered in part; and what is no mirror is refused."""

import numpy as np
import pytest

from vision_core.client.recognition import find_rim
from vision_core.errors import SourceError
from vision_core.geometry import Bytes

CENTER, RADIUS = (151.3, 118.8), 96.4


def disc(center: tuple[float, float] = CENTER, radius: float = RADIUS, noise: float = 6.0) -> Bytes:
    """A grey disc before a dark outside, with a blurred border and noise."""
    columns, rows = np.meshgrid(np.arange(320.0), np.arange(240.0))
    share = np.clip(radius + 0.5 - np.hypot(columns - center[0], rows - center[1]), 0.0, 1.0)
    light = 18.0 + 100.0 * share + np.random.default_rng(3).normal(0.0, noise, share.shape)
    return np.repeat(np.clip(light, 0.0, 255.0).astype(np.uint8)[..., None], 3, axis=2)


def test_a_whole_rim() -> None:
    rim = find_rim(disc())
    assert (rim.column, rim.row) == pytest.approx(CENTER, abs=0.15)
    assert rim.radius_px == pytest.approx(RADIUS, abs=0.5)


def test_a_rim_that_the_picture_cuts() -> None:
    rim = find_rim(disc((130.0, 119.5), 140.0))
    assert (rim.column, rim.row) == pytest.approx((130.0, 119.5), abs=0.4)
    assert rim.radius_px == pytest.approx(140.0, abs=0.8)


def test_dark_things_at_the_rim() -> None:
    picture = disc()
    picture[:110, 130:190] = 20
    picture[150:, 40:100] = 20
    rim = find_rim(picture)
    assert (rim.column, rim.row) == pytest.approx(CENTER, abs=0.5)


@pytest.mark.parametrize(
    ("picture", "complaint"),
    [
        (np.full((240, 320, 3), 15, dtype=np.uint8), "dark all over"),
        (np.full((240, 320, 3), 150, dtype=np.uint8), "corners of brightness 150"),
        (np.pad(np.full((30, 280, 3), 150, dtype=np.uint8), ((105, 105), (20, 20), (0, 0))), "no circle"),
        (np.zeros((0, 0, 3), dtype=np.uint8), r"shape \(0, 0, 3\)"),
        (np.zeros((240, 320), dtype=np.uint8), "a color picture"),
    ],
)
def test_what_has_no_rim_is_refused(picture: Bytes, complaint: str) -> None:
    with pytest.raises(SourceError, match=complaint):
        find_rim(picture)
