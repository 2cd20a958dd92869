"""How large things must look, from the camera model."""

import numpy as np

from vision_core.camera_model import CameraModel
from vision_core.geometry import Floats

STEP_M = 1e-3


def pixels_per_square_metre(camera: CameraModel, points_m: Floats, height_m: float) -> Floats:
    """Area of the picture that a square metre at points of a plane covers [px/m^2].

    points_m: shape (n, 2) [m]; returns shape (n,). The determinant of the map's Jacobian.
    """
    count = len(points_m)
    steps = np.array([[0.0, 0.0], [STEP_M, 0.0], [0.0, STEP_M]])
    corners = (steps[:, None] + points_m).reshape(-1, 2)
    pixels = camera.pixel_from_field(corners, height_m)
    along, across = pixels[count : 2 * count] - pixels[:count], pixels[2 * count :] - pixels[:count]
    area: Floats = np.abs(along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]) / STEP_M**2
    return area


def likeness(share: Floats) -> Floats:
    """How near measured areas are to the predicted ones, 0..1: the root of the smaller over the larger."""
    with np.errstate(divide="ignore"):
        alike: Floats = np.sqrt(np.minimum(share, 1.0 / share))
    return alike
