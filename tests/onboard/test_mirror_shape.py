"""The reflection at the hyperboloid is equation 1."""

import math

import numpy as np
import pytest

from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.onboard.mirror_shape import MirrorShape

MIRRORS = (
    PAPER_MIRROR,
    Mirror(1.933098, 0.00296946, 360000.0),  # division B
    Mirror(8.591547, 0.01583711, 250000.0),  # Very Small Size
    Hyperboloid(150.0, 100.0, 1.2).mirror(),
)


@pytest.mark.parametrize("mirror", MIRRORS)
def test_constants_and_shape_are_one_to_one(mirror: Mirror) -> None:
    back = Hyperboloid.of(mirror).mirror()
    assert (back.a, back.b, back.c) == pytest.approx((mirror.a, mirror.b, mirror.c), rel=1e-12)


def test_the_shape_that_the_papers_numbers_imply() -> None:
    shape = MirrorShape.from_mirror(PAPER_MIRROR)
    assert shape.f_px == 300.0
    assert shape.h_m == pytest.approx(0.219, abs=1e-4)
    assert shape.u == pytest.approx(1.739, abs=1e-3)
    assert shape.c_m**2 == pytest.approx(shape.a_m**2 + shape.b_m**2)


@pytest.mark.parametrize("mirror", MIRRORS)
def test_reflected_rays_meet_the_floor_where_equation_1_says(mirror: Mirror) -> None:
    shape = MirrorShape.from_mirror(mirror)
    r_mm = np.array([20.0, 110.0, 220.0, 500.0, 1000.0, 2750.0, 10_000.0])[:, None]
    angle = np.linspace(0.0, math.tau, 13)
    r_px = mirror.px_from_mm(r_mm)
    px, py, pz, dx, dy, dz = shape.rays_from_px(r_px * np.cos(angle), r_px * np.sin(angle))
    along = (pz - shape.c_m + shape.h_m) / -dz
    x, y = px + along * dx, py + along * dy
    np.testing.assert_allclose(mirror.px_from_mm(np.hypot(x, y) * 1000.0), np.broadcast_to(r_px, x.shape), atol=1e-6)
    np.testing.assert_allclose(np.cos(np.arctan2(y, x) - angle), np.ones_like(x), atol=1e-12)


@pytest.mark.parametrize("mirror", MIRRORS)
def test_reflected_rays_pass_through_the_viewpoint_and_leave_points_of_the_mirror(mirror: Mirror) -> None:
    shape = MirrorShape.from_mirror(mirror)
    forward, left = np.meshgrid(np.linspace(-70.0, 70.0, 9), np.linspace(-60.0, 60.0, 8))
    px, py, pz, dx, dy, dz = shape.rays_from_px(forward, left)
    np.testing.assert_allclose(pz**2 / shape.b_m**2 - (px**2 + py**2) / shape.a_m**2, np.ones_like(px), atol=1e-9)
    assert (pz > 0.0).all()
    np.testing.assert_allclose(dx**2 + dy**2 + dz**2, np.ones_like(px), atol=1e-12)
    from_focus = np.stack([px, py, pz - shape.c_m])
    across = np.cross(from_focus, np.stack([dx, dy, dz]), axis=0)
    np.testing.assert_allclose(across, np.zeros_like(across), atol=1e-12)


def test_no_ray_of_a_mirror_that_sees_the_horizon_leaves_its_sheet() -> None:
    for mirror in MIRRORS:
        assert MirrorShape.from_mirror(mirror).asymptote_px > 1.05 * mirror.horizon_px
