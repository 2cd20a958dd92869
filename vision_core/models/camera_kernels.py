"""The camera models in compiled code: one form for both, for one point at a time.

A pinhole camera is a homography, undistorted plane of the lens -> floor, behind a lens distortion. A camera from named
points is the same homography behind a lens without distortion. ``models.camera`` is the readable reference; a test
compares the two.
"""

from typing import NamedTuple

import numpy as np

from vision_core.geometry import Floats, frozen
from vision_core.models.camera import STEP_M, CameraModel, HomographyCamera, PinholeCamera
from vision_core.native.kernels import kernel

NEWTON_STEPS = 20
"""At most; the lens of a ceiling camera needs three or four."""
NEWTON_TOLERANCE = 1e-7
"""In focal lengths. Newton's method squares the error: the step taken at this error leaves less than 1e-13."""


class CameraMap(NamedTuple):
    """A camera as an argument of kernels; its arrays are read-only."""

    position_m: Floats
    """Optical center in the field [m], shape (3,)."""
    lens: Floats
    """Focal length, center x and y [px], k1, k2, p1, p2, k3: shape (8,)."""
    floor_from_plane: Floats
    """Homography from the undistorted plane of the lens to the floor [m], shape (3, 3); third row: 1 / depth."""
    plane_from_floor: Floats
    """Its inverse, shape (3, 3); third row: depth along the optical axis."""
    one_sided: bool
    """Whether points behind the camera give nan, as they do for a pinhole."""


def camera_map_from(camera: CameraModel) -> CameraMap:
    """A camera model's CameraMap. Raises TypeError for a class of models without one."""
    if isinstance(camera, PinholeCamera):
        return _of_pinhole(camera)
    if isinstance(camera, HomographyCamera):
        no_lens = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        return CameraMap(
            camera.position_m,
            frozen(no_lens),
            _matrix(camera.floor_from_image),
            _matrix(camera.image_from_floor),
            False,
        )
    raise TypeError(f"no compiled form of {type(camera).__name__}")


def _of_pinhole(camera: PinholeCamera) -> CameraMap:
    turn, center = camera.camera_from_field, camera.position_m
    plane_from_floor = np.column_stack([turn[:, 0], turn[:, 1], turn @ -center])
    rays = turn.T  # of the plane's x, y, 1, in the field
    floor_from_plane = np.vstack([center[2] * rays[:2] - center[:2, None] * rays[2], -rays[2:]])
    lens = frozen(np.array([camera.focal_px, *camera.center_px, *camera.distortion]))
    return CameraMap(center, lens, _matrix(floor_from_plane), _matrix(plane_from_floor), True)


def _matrix(matrix: Floats) -> Floats:
    return frozen(np.array(matrix, dtype=np.float64, order="C"))


@kernel
def field_from_pixel(camera: CameraMap, x_px: float, y_px: float, height_m: float) -> tuple[float, float]:
    """Where the ray through a pixel crosses the plane at a height: (x, y) [m], nan if it does not."""
    x_m, y_m, _ = field_and_scale(camera, x_px, y_px, height_m)
    return x_m, y_m


@kernel
def field_and_scale(camera: CameraMap, x_px: float, y_px: float, height_m: float) -> tuple[float, float, float]:
    """``field_from_pixel``, and the area of the image that a square metre covers there [px/m^2]."""
    lens, floor = camera.lens, camera.floor_from_plane
    u, v, spread = _undistorted(lens, (x_px - lens[1]) / lens[0], (y_px - lens[2]) / lens[0])
    w = floor[2, 0] * u + floor[2, 1] * v + floor[2, 2]
    if camera.one_sided and not w > 0.0:
        return np.nan, np.nan, np.nan
    x = (floor[0, 0] * u + floor[0, 1] * v + floor[0, 2]) / w
    y = (floor[1, 0] * u + floor[1, 1] * v + floor[1, 2]) / w
    share = height_m / camera.position_m[2]
    volume = (
        floor[0, 0] * (floor[1, 1] * floor[2, 2] - floor[1, 2] * floor[2, 1])
        - floor[0, 1] * (floor[1, 0] * floor[2, 2] - floor[1, 2] * floor[2, 0])
        + floor[0, 2] * (floor[1, 0] * floor[2, 1] - floor[1, 1] * floor[2, 0])
    )
    nearer = lens[0] / (1.0 - share)
    scale = abs(nearer * nearer * spread * w * w * w / volume)
    return x + (camera.position_m[0] - x) * share, y + (camera.position_m[1] - y) * share, scale


@kernel
def field_steps(camera: CameraMap, x_px: float, y_px: float, height_m: float) -> tuple[float, float, float, float]:
    """How x and y in the field change with one pixel to the right, and with one pixel down [m/px]."""
    left_x, left_y = field_from_pixel(camera, x_px - 1.0, y_px, height_m)
    right_x, right_y = field_from_pixel(camera, x_px + 1.0, y_px, height_m)
    up_x, up_y = field_from_pixel(camera, x_px, y_px - 1.0, height_m)
    down_x, down_y = field_from_pixel(camera, x_px, y_px + 1.0, height_m)
    return 0.5 * (right_x - left_x), 0.5 * (right_y - left_y), 0.5 * (down_x - up_x), 0.5 * (down_y - up_y)


@kernel
def pixel_from_field(camera: CameraMap, x_m: float, y_m: float, height_m: float) -> tuple[float, float]:
    """The pixel at which a point of the field at a height is seen: (x, y) [px], nan behind the camera."""
    lens, plane = camera.lens, camera.plane_from_floor
    share = height_m / camera.position_m[2]
    x = (x_m - camera.position_m[0] * share) / (1.0 - share)
    y = (y_m - camera.position_m[1] * share) / (1.0 - share)
    w = plane[2, 0] * x + plane[2, 1] * y + plane[2, 2]
    if camera.one_sided and not w > 0.0:
        return np.nan, np.nan
    u = (plane[0, 0] * x + plane[0, 1] * y + plane[0, 2]) / w
    v = (plane[1, 0] * x + plane[1, 1] * y + plane[1, 2]) / w
    bent_u, bent_v = _distorted(lens, u, v)
    return bent_u * lens[0] + lens[1], bent_v * lens[0] + lens[2]


@kernel
def pixels_per_square_metre(camera: CameraMap, x_m: float, y_m: float, height_m: float) -> float:
    """Area of the image that a square metre at a point of a plane covers [px/m^2]."""
    here_x, here_y = pixel_from_field(camera, x_m, y_m, height_m)
    ahead_x, ahead_y = pixel_from_field(camera, x_m + STEP_M, y_m, height_m)
    aside_x, aside_y = pixel_from_field(camera, x_m, y_m + STEP_M, height_m)
    area = (ahead_x - here_x) * (aside_y - here_y) - (ahead_y - here_y) * (aside_x - here_x)
    return abs(area) / (STEP_M * STEP_M)


@kernel
def _distorted(lens: Floats, x: float, y: float) -> tuple[float, float]:
    k1, k2, p1, p2, k3 = lens[3], lens[4], lens[5], lens[6], lens[7]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    )


@kernel
def _undistorted(lens: Floats, u: float, v: float) -> tuple[float, float, float]:
    """Undistort a point by Newton's method: returns (x, y) in the undistorted plane, and the factor by which the lens
    enlarges areas there; nan when there is no solution."""
    k1, k2, p1, p2, k3 = lens[3], lens[4], lens[5], lens[6], lens[7]
    if k1 == 0.0 and k2 == 0.0 and p1 == 0.0 and p2 == 0.0 and k3 == 0.0:
        return u, v, 1.0
    x, y = u, v
    for _ in range(NEWTON_STEPS):
        bent_x, bent_y = _distorted(lens, x, y)
        off_x, off_y = bent_x - u, bent_y - v
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))
        xx = radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x
        xy = x * y * slope + 2.0 * (p1 * x + p2 * y)
        yy = radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x
        volume = xx * yy - xy * xy
        x -= (off_x * yy - off_y * xy) / volume
        y -= (off_y * xx - off_x * xy) / volume
        if abs(off_x) + abs(off_y) < NEWTON_TOLERANCE:
            return x, y, volume
    return np.nan, np.nan, np.nan
