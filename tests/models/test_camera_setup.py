"""The part of the floor that a camera sees."""

import numpy as np

from vision_core.models.camera_setup import CameraSetup
from vision_core.venues.loader import load_settings


def test_the_border_of_the_seen_floor_is_that_of_the_picture() -> None:
    camera = CameraSetup.from_settings(load_settings())
    floor = camera.seen_floor_m(12)
    assert floor.shape == (48, 2)
    width, height = camera.size_px
    corners = camera.model.pixel_from_field(floor[::12])
    np.testing.assert_allclose(corners, [[0, 0], [width, 0], [width, height], [0, height]], atol=0.05)
