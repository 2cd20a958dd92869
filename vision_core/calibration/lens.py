"""A lens, its pose and the field's measures as parameters that a solver moves, with the analytic Jacobian.

Spaces and model as ``models.camera.PinholeCamera``, of which this is the form for solving. The rotation moves by small
turns about the camera's own axes, so that no direction of view is special.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from vision_core.geometry import Floats
from vision_core.models.camera import PinholeCamera
from vision_core.settings.schema import PinholeSettings

MEASURES = ("width_m", "penalty_depth_m", "penalty_width_m", "center_circle_radius_m")
"""Of the field, which may be solved too; its length sets the scale."""
PARAMETERS = (
    "focal",
    "center_x",
    "center_y",
    "k1",
    "k2",
    "p1",
    "p2",
    "x",
    "y",
    "z",
    "turn_x",
    "turn_y",
    "turn_z",
    *MEASURES,
)
FOCAL, CENTER, DISTORTION, POSITION, TURN, STRETCH = (
    0,
    slice(1, 3),
    slice(3, 7),
    slice(7, 10),
    slice(10, 13),
    slice(13, 17),
)
HEIGHT = 9
"""Index of the height in PARAMETERS."""
COUNT = len(PARAMETERS)


@dataclass(frozen=True, slots=True, eq=False)
class Lens:
    """A pinhole with distortion (k1, k2, p1, p2) and a pose over the floor."""

    focal_px: float
    center_px: Floats
    """Shape (2,)."""
    distortion: Floats
    """k1, k2, p1, p2; shape (4,)."""
    position_m: Floats
    """Shape (3,)."""
    camera_from_field: Floats
    """Rotation, shape (3, 3)."""
    stretch: Floats = field(default_factory=lambda: np.zeros(len(MEASURES)))
    """How much larger the field's MEASURES are than its settings say [m], shape (4,)."""
    k3: float = 0.0
    """Of a lens that was measured with a board; lines do not determine it, so it stays as it is."""

    @classmethod
    def from_camera(cls, camera: PinholeCamera) -> "Lens":
        """The same lens and pose."""
        center, distortion = camera.center_px.copy(), camera.distortion[:4].copy()
        position, rotation = camera.position_m.copy(), camera.camera_from_field.copy()
        return cls(camera.focal_px, center, distortion, position, rotation, k3=float(camera.distortion[4]))

    @classmethod
    def from_settings(cls, lens: PinholeSettings) -> "Lens":
        """The lens and pose of [camera.pinhole]."""
        position = lens.position_m
        return cls.from_camera(
            PinholeCamera(lens.focal_px, lens.center_px, lens.distortion, position, lens.rotation_deg)
        )

    def from_other_end(self) -> "Lens":
        """The same camera over the field turned by half a turn: left and right goal are exchanged."""
        half_turn = np.diag([-1.0, -1.0, 1.0])
        return replace(
            self, position_m=half_turn @ self.position_m, camera_from_field=self.camera_from_field @ half_turn
        )

    @property
    def values(self) -> Floats:
        """All parameters in the order of PARAMETERS, the turns 0; shape (17,)."""
        return np.concatenate(
            [[self.focal_px], self.center_px, self.distortion, self.position_m, np.zeros(3), self.stretch]
        )

    def moved(self, step: Floats) -> "Lens":
        """The lens after a step of the parameters, shape (17,)."""
        return replace(
            self,
            focal_px=self.focal_px + float(step[FOCAL]),
            center_px=self.center_px + step[CENTER],
            distortion=self.distortion + step[DISTORTION],
            position_m=self.position_m + step[POSITION],
            camera_from_field=_turn(step[TURN]) @ self.camera_from_field,
            stretch=self.stretch + step[STRETCH],
        )

    def project(self, points: Floats) -> Floats:
        """Pixels of floor points: shape (n, 2) [m] -> (n, 2) [px]; nan behind the camera."""
        pixels: Floats = self._distorted(self._plane(self._in_camera(points))) * self.focal_px + self.center_px
        return pixels

    def jacobian(self, points: Floats, moves: Floats | None = None) -> Floats:
        """How the pixels of floor points move with the parameters: shape (n, 2) [m] -> (n, 2, 17).

        moves: how the points move with the field's measures, shape (n, 2, 4); None: they do not.
        """
        seen = self._in_camera(points)
        plane = self._plane(seen)
        u, v = plane.T
        k1, k2, p1, p2 = self.distortion
        r2 = u * u + v * v
        radial, slope = 1.0 + r2 * (k1 + r2 * (k2 + r2 * self.k3)), k1 + r2 * (2.0 * k2 + 3.0 * r2 * self.k3)
        mixed = 2.0 * (u * v * slope + p1 * u + p2 * v)
        bent = np.empty((len(points), 2, 2))  # distorted by undistorted
        bent[:, 0, 0] = radial + 2.0 * u * u * slope + 2.0 * p1 * v + 6.0 * p2 * u
        bent[:, 1, 1] = radial + 2.0 * v * v * slope + 6.0 * p1 * v + 2.0 * p2 * u
        bent[:, 0, 1] = bent[:, 1, 0] = mixed
        from_seen = np.zeros((len(points), 2, 3))  # undistorted by the point in camera space
        from_seen[:, 0, 0] = from_seen[:, 1, 1] = 1.0 / seen[:, 2]
        from_seen[:, :, 2] = -plane / seen[:, 2:]
        chain = self.focal_px * bent @ from_seen
        result = np.zeros((len(points), 2, COUNT))
        result[:, :, FOCAL] = self._distorted(plane)
        result[:, :, CENTER] = np.eye(2)
        result[:, :, 3] = self.focal_px * plane * r2[:, None]
        result[:, :, 4] = self.focal_px * plane * (r2 * r2)[:, None]
        result[:, :, 5] = self.focal_px * np.column_stack([2.0 * u * v, r2 + 2.0 * v * v])
        result[:, :, 6] = self.focal_px * np.column_stack([r2 + 2.0 * u * u, 2.0 * u * v])
        result[:, :, POSITION] = chain @ -self.camera_from_field
        result[:, :, TURN] = chain @ _cross(seen)
        if moves is not None:
            result[:, :, STRETCH] = -result[:, :, 7:9] @ moves
        return result

    def settings(self) -> PinholeSettings:
        """As [camera.pinhole] of a venue's file says it."""
        k1, k2, p1, p2 = (round(float(k), 6) for k in self.distortion)
        turned = self.camera_from_field @ np.diag([1.0, -1.0, -1.0])
        about_y = math.asin(min(max(turned[0, 2], -1.0), 1.0))
        angles = math.atan2(-turned[1, 2], turned[2, 2]), about_y, math.atan2(-turned[0, 1], turned[0, 0])
        x_deg, y_deg, z_deg = (round(math.degrees(angle), 5) for angle in angles)
        x_m, y_m, z_m = (round(float(value), 5) for value in self.position_m)
        return PinholeSettings(
            focal_px=round(self.focal_px, 3),
            center_px=(round(float(self.center_px[0]), 3), round(float(self.center_px[1]), 3)),
            distortion=(k1, k2, p1, p2, round(self.k3, 6)),
            position_m=(x_m, y_m, z_m),
            rotation_deg=(x_deg, y_deg, z_deg),
        )

    def camera(self) -> PinholeCamera:
        """As a camera model, of the values that ``settings`` rounds."""
        lens = self.settings()
        return PinholeCamera(lens.focal_px, lens.center_px, lens.distortion, lens.position_m, lens.rotation_deg)

    def _in_camera(self, points: Floats) -> Floats:
        arms = np.column_stack([points - self.position_m[:2], np.full(len(points), -self.position_m[2])])
        seen: Floats = arms @ self.camera_from_field.T
        return seen

    @staticmethod
    def _plane(seen: Floats) -> Floats:
        with np.errstate(divide="ignore", invalid="ignore"):
            plane: Floats = np.where(seen[:, 2:] > 0.0, seen[:, :2] / seen[:, 2:], np.nan)
        return plane

    def _distorted(self, plane: Floats) -> Floats:
        k1, k2, p1, p2 = self.distortion
        u, v = plane.T
        r2 = u * u + v * v
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * self.k3))
        x = u * radial + 2.0 * p1 * u * v + p2 * (r2 + 2.0 * u * u)
        y = v * radial + p1 * (r2 + 2.0 * v * v) + 2.0 * p2 * u * v
        return np.column_stack([x, y])


def _turn(vector: Floats) -> Floats:
    """The rotation by a vector: its direction is the axis, its length the angle [rad]."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return np.eye(3)
    cross = _cross(-vector[None] / angle)[0]
    turned: Floats = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return turned


def _cross(vectors: Floats) -> Floats:
    """Matrices C with C w = w x v: shape (n, 3) -> (n, 3, 3)."""
    result = np.zeros((len(vectors), 3, 3))
    x, y, z = vectors.T
    result[:, 0, 1], result[:, 0, 2] = z, -y
    result[:, 1, 0], result[:, 1, 2] = -z, x
    result[:, 2, 0], result[:, 2, 1] = y, -x
    return result
