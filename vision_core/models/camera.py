"""Camera models: maps between image pixels and the field at any height, and back.

Spaces: *image*, pixels, origin at the center of the top left pixel, x right, y down. *Field*: see
``geometry``; z up from the floor. *Camera*: origin at the optical center, x right and y down in the
image, z along the optical axis; metres.

Both models map between the image and the floor, and have the position of the optical center. All other heights follow
from these two: the point at height h on the ray from the optical center (c, H) to the floor point p is
p + (c - p) h / H. Example: a marker 150 mm high, 1.4 m off axis under a camera at 4 m, would be placed
54 mm too far out if its height were ignored.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Floats, frozen

UNDISTORT_STEPS = 60
UNDISTORT_TOLERANCE = 1e-12
STEP_M = 1e-3
"""Step of the finite differences that measure the image's scale."""


class CameraModel(ABC):
    """A calibrated camera over the field."""

    def __init__(self, position_m: Sequence[float]) -> None:
        self.position_m: Floats = frozen(np.array(position_m, dtype=np.float64))
        """Optical center in the field [m], shape (3,)."""

    def field_from_pixel(self, pixels: Floats, height_m: float = 0.0) -> Floats:
        """Where the rays through pixels cross the plane at a height.

        pixels: shape (n, 2) [px]; returns shape (n, 2) [m]; nan for a ray that does not reach the plane.
        """
        floor = self._floor_from_pixel(np.asarray(pixels, dtype=np.float64).reshape(-1, 2))
        above: Floats = floor + (self.position_m[:2] - floor) * (height_m / self.position_m[2])
        return above

    def pixel_from_field(self, points: Floats, height_m: float | Floats = 0.0) -> Floats:
        """The pixels at which points of the field at a height are seen.

        points: shape (n, 2) [m]; height_m: one height or shape (n,); returns shape (n, 2) [px].
        """
        share = np.asarray(height_m, dtype=np.float64).reshape(-1, 1) / self.position_m[2]
        above = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        return self._pixel_from_floor((above - self.position_m[:2] * share) / (1.0 - share))

    def pixels_per_metre(self, point_m: Sequence[float], height_m: float = 0.0) -> float:
        """Scale of the image at a point of the field [px/m]: square root of the area that a square metre covers."""
        return math.sqrt(self.pixels_per_square_metre(np.array([point_m]), height_m)[0])

    def pixels_per_square_metre(self, points: Floats, height_m: float = 0.0) -> Floats:
        """Area of the image that a square metre at points of a plane covers [px/m^2].

        points: shape (n, 2) [m]; returns shape (n,). The determinant of the map's Jacobian.
        """
        steps = np.array([[0.0, 0.0], [STEP_M, 0.0], [0.0, STEP_M]])
        here, ahead, aside = self.pixel_from_field(steps[:, None] + points, height_m).reshape(3, -1, 2)
        along, across = ahead - here, aside - here
        area: Floats = np.abs(along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]) / STEP_M**2
        return area

    @abstractmethod
    def _floor_from_pixel(self, pixels: Floats) -> Floats: ...

    @abstractmethod
    def _pixel_from_floor(self, points: Floats) -> Floats: ...


class PinholeCamera(CameraModel):
    """Pinhole with Brown-Conrady distortion (k1, k2, p1, p2, k3, as OpenCV orders them) and a pose.

    With ``rotation_deg`` (0, 0, 0) the camera looks straight down, image x along field x.
    The three angles turn the camera about its own x, y and z axis [deg].
    """

    def __init__(
        self,
        focal_px: float,
        center_px: Sequence[float],
        distortion: Sequence[float],
        position_m: Sequence[float],
        rotation_deg: Sequence[float],
    ) -> None:
        super().__init__(position_m)
        self.focal_px = focal_px
        self.center_px: Floats = frozen(np.array(center_px, dtype=np.float64))
        self.distortion: Floats = frozen(np.array(distortion, dtype=np.float64))
        self.camera_from_field: Floats = frozen(_camera_from_field(rotation_deg))

    def ray_from_pixel(self, pixels: Floats) -> Floats:
        """Directions in the field of the rays through pixels: shape (n, 2) [px] -> (n, 3), not of unit length."""
        plane = self._undistorted((pixels - self.center_px) / self.focal_px)
        rays: Floats = np.column_stack([plane, np.ones(len(plane))]) @ self.camera_from_field
        return rays

    def _floor_from_pixel(self, pixels: Floats) -> Floats:
        rays = self.ray_from_pixel(pixels)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.where(rays[:, 2] < 0.0, -self.position_m[2] / rays[:, 2], np.nan)
        floor: Floats = self.position_m[:2] + rays[:, :2] * reach[:, None]
        return floor

    def _pixel_from_floor(self, points: Floats) -> Floats:
        arms = np.column_stack([points - self.position_m[:2], np.full(len(points), -self.position_m[2])])
        in_camera = arms @ self.camera_from_field.T
        with np.errstate(divide="ignore", invalid="ignore"):
            plane = np.where(in_camera[:, 2:] > 0.0, in_camera[:, :2] / in_camera[:, 2:], np.nan)
        return self._distorted(plane) * self.focal_px + self.center_px

    def _distorted(self, plane: Floats) -> Floats:
        k1, k2, p1, p2, k3 = self.distortion
        x, y = plane[:, 0], plane[:, 1]
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return np.column_stack(
            [
                x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
            ]
        )

    def _undistorted(self, plane: Floats) -> Floats:
        guess = plane.copy()
        for _ in range(UNDISTORT_STEPS):
            error = self._distorted(guess) - plane
            guess -= error
            if not np.abs(error).max(initial=0.0) > UNDISTORT_TOLERANCE:
                break
        return guess


class HomographyCamera(CameraModel):
    """A plane-to-plane map from four or more named points of the floor, for a venue without a calibrated lens.

    The camera's position must be measured with a tape: points of one plane do not determine it.
    """

    def __init__(self, pixels: Floats, points_m: Floats, position_m: Sequence[float]) -> None:
        super().__init__(position_m)
        self.floor_from_image: Floats = frozen(homography(pixels, points_m))
        self.image_from_floor: Floats = frozen(np.asarray(np.linalg.inv(self.floor_from_image), dtype=np.float64))

    def _floor_from_pixel(self, pixels: Floats) -> Floats:
        return mapped(self.floor_from_image, pixels)

    def _pixel_from_floor(self, points: Floats) -> Floats:
        return mapped(self.image_from_floor, points)


def homography(source: Floats, target: Floats) -> Floats:
    """The 3x3 matrix that maps four or more points to their partners (direct linear transform).

    source, target: shape (n, 2), n >= 4. Raises SettingsError when three of four points lie on a line.
    """
    here, normal_here = _normalized(source)
    there, normal_there = _normalized(target)
    rows = []
    for (x, y), (u, v) in zip(here, there, strict=True):
        rows.append([x, y, 1, 0, 0, 0, -u * x, -u * y, -u])
        rows.append([0, 0, 0, x, y, 1, -v * x, -v * y, -v])
    _, sizes, right = np.linalg.svd(np.array(rows, dtype=np.float64))
    if sizes[7] < 1e-6 * sizes[0]:
        raise SettingsError(
            "a camera from four named points",
            found="points of which three lie on one line (or two that coincide)",
            accepted="four points that span the field",
        )
    matrix: Floats = np.linalg.inv(normal_there) @ right[-1].reshape(3, 3) @ normal_here
    scaled: Floats = matrix / matrix[2, 2]
    return scaled


def _normalized(points: Floats) -> tuple[Floats, Floats]:
    """Points shifted to mean 0 and scaled to mean deviation 1, and the matrix that does so."""
    mean = points.mean(axis=0)
    scale = 1.0 / max(float(np.abs(points - mean).mean()), 1e-12)
    matrix = np.array([[scale, 0.0, -scale * mean[0]], [0.0, scale, -scale * mean[1]], [0.0, 0.0, 1.0]])
    return (points - mean) * scale, matrix


def mapped(matrix: Floats, points: Floats) -> Floats:
    """Points, shape (n, 2), mapped by a homography, shape (3, 3)."""
    lifted = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    mapped: Floats = lifted[:, :2] / lifted[:, 2:]
    return mapped


def _camera_from_field(rotation_deg: Sequence[float]) -> Floats:
    a, b, c = (math.radians(angle) for angle in rotation_deg)
    about_x = np.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    about_y = np.array([[math.cos(b), 0, math.sin(b)], [0, 1, 0], [-math.sin(b), 0, math.cos(b)]])
    about_z = np.array([[math.cos(c), -math.sin(c), 0], [math.sin(c), math.cos(c), 0], [0, 0, 1]])
    downwards = np.diag([1.0, -1.0, -1.0])
    turned: Floats = about_x @ about_y @ about_z @ downwards
    return turned
