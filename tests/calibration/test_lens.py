"""A lens for solving is the camera model, and its Jacobian is its derivative."""

import numpy as np
import pytest

from vision_core.calibration.lens import COUNT, Lens
from vision_core.models.camera import PinholeCamera

CAMERA = PinholeCamera(
    700.0, (318.0, 241.0), (-0.09, 0.02, 0.0005, -0.0004, 0.0), (0.06, -0.04, 3.75), (-6.0, 9.0, 50.0)
)
POINTS = np.random.default_rng(1).uniform(-1.0, 1.0, (20, 2))


def test_it_projects_as_the_camera_model() -> None:
    lens = Lens.from_camera(CAMERA)
    assert lens.project(POINTS) == pytest.approx(CAMERA.pixel_from_field(POINTS))
    assert lens.camera().pixel_from_field(POINTS) == pytest.approx(CAMERA.pixel_from_field(POINTS), abs=1e-3)


@pytest.mark.parametrize("parameter", range(COUNT))
def test_the_jacobian_is_the_derivative(parameter: int) -> None:
    lens, step = Lens.from_camera(CAMERA), np.zeros(COUNT)
    step[parameter] = 1e-6
    measured = (lens.moved(step).project(POINTS) - lens.moved(-step).project(POINTS)) / 2e-6
    assert lens.jacobian(POINTS)[:, :, parameter] == pytest.approx(measured, abs=1e-5)


def test_the_other_end_is_half_a_turn() -> None:
    turned = Lens.from_camera(CAMERA).from_other_end()
    assert turned.project(-POINTS) == pytest.approx(CAMERA.pixel_from_field(POINTS))
    assert Lens.from_settings(turned.settings()).project(-POINTS) == pytest.approx(turned.project(-POINTS), abs=1e-2)
