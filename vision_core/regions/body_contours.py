"""What the bodies of robots cover in a camera's picture, told as the part of the floor that the camera cannot see.

After B-Human's body contour, for a camera on the ceiling: a robot is an upright cylinder, and what it hides of the
floor is the hull of two circles, its foot and the shadow of its top as a lamp at the camera would throw it. The
silhouette in the picture is the image of that hull. So one test in the field's plane says whether a robot covers a
point of the floor, and neither the lens nor the picture's size has any influence.
"""

import math

import numpy as np

from vision_core.geometry import Floats, Mask

OUTLINE_POINTS = 32
BALL_DIRECTIONS = np.arange(8) * (math.tau / 8.0)
BALL_SHARES = 0.5, 0.95
"""A ball is judged at its middle and on two circles, in shares of its radius."""
HIDDEN_SHARE = 0.75
"""A ball of which more is covered may not be seen: what is left is too little to be taken for a ball."""


class BodySilhouettes:
    """Robots of one size under one camera. Holds no state."""

    def __init__(self, eye_m: Floats, radius_m: float, height_m: float) -> None:
        """eye_m: optical center in the field, shape (3,); radius_m, height_m: of the robots' bodies.

        Raises ValueError for a camera that is not above the robots.
        """
        if not eye_m[2] > height_m:
            raise ValueError(f"a camera {eye_m[2]:g} m high does not look down on robots of {height_m:g} m")
        self._eye = eye_m
        self._foot = radius_m
        self._stretch = height_m / (eye_m[2] - height_m)
        self._growth = radius_m * self._stretch

    def covered(self, points_m: Floats, robots_m: Floats, margin_m: float = 0.0) -> Mask:
        """Which points of the floor some robot covers.

        points_m: shape (n, 2); robots_m: places of the robots, shape (k, 2); margin_m: added to the bodies' radius, for
        robots that have moved meanwhile. Returns shape (n,).
        """
        if not len(robots_m) or not len(points_m):
            return np.zeros(len(points_m), dtype=np.bool_)
        covered: Mask = np.any(self._distances(points_m, robots_m) <= margin_m, axis=1)
        return covered

    def hidden_share(self, ball_m: Floats, radius_m: float, robots_m: Floats) -> float:
        """How much of a ball robots cover, 0..1. ball_m: its point on the floor, shape (2,); robots_m: shape (k, 2)."""
        return float(self.covered(self._ball_on_floor(ball_m, radius_m), robots_m).mean())

    def hiding(self, ball_m: Floats, radius_m: float, robots_m: Floats) -> Mask:
        """Which robots cover some of a ball; the arguments of ``hidden_share``. Returns shape (k,)."""
        if not len(robots_m):
            return np.zeros(0, dtype=np.bool_)
        some: Mask = np.any(self._distances(self._ball_on_floor(ball_m, radius_m), robots_m) <= 0.0, axis=0)
        return some

    def can_hide(self, radius_m: float, robots_m: Floats) -> Mask:
        """Behind which robots a ball that touches them may not be seen. radius_m: the ball's. Returns shape (k,)."""
        places = robots_m + self._outward(robots_m) * (self._foot + radius_m)
        pairs = zip(places, robots_m, strict=True)
        return np.array(
            [self.hidden_share(ball, radius_m, robot[None]) > HIDDEN_SHARE for ball, robot in pairs], dtype=np.bool_
        )

    def outlines(self, robots_m: Floats) -> Floats:
        """The covered part of the floor of every robot, anticlockwise, shape (k, OUTLINE_POINTS, 2) [m]."""
        outward = self._outward(robots_m)
        shadow = (robots_m - self._eye[:2]) * self._stretch
        length = np.hypot(shadow[:, 0], shadow[:, 1])
        # both tangents touch the circles where their normal is at this angle to the direction away from the camera
        touch = np.arccos(np.clip(-self._growth / np.maximum(length, 1e-12), -1.0, 1.0))
        half = OUTLINE_POINTS // 2
        front = np.linspace(-touch, touch, half, axis=1)
        back = np.linspace(touch, math.tau - touch, half, axis=1)
        angles = np.concatenate([front, back], axis=1) + np.arctan2(outward[:, 1], outward[:, 0])[:, None]
        # below the camera the top's circle contains the foot's
        is_top = (np.arange(OUTLINE_POINTS) < half) | (length <= self._growth)[:, None]
        centers = robots_m[:, None] + np.where(is_top[..., None], shadow[:, None], 0.0)
        radii = np.where(is_top, self._foot + self._growth, self._foot)
        outlines: Floats = centers + radii[..., None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        return outlines

    def _outward(self, robots_m: Floats) -> Floats:
        """Unit vectors away from the camera, shape (k, 2); of a robot right below it, along x."""
        away = robots_m - self._eye[:2]
        length = np.hypot(away[:, 0], away[:, 1])[:, None]
        unit: Floats = np.where(length > 0.0, away / np.maximum(length, 1e-12), (1.0, 0.0))
        return unit

    def _ball_on_floor(self, ball_m: Floats, radius_m: float) -> Floats:
        """Where the camera sees points of a ball on the floor, shape (n, 2) [m]."""
        share = radius_m / (self._eye[2] - radius_m)
        center = ball_m + (ball_m - self._eye[:2]) * share
        circle = np.column_stack([np.cos(BALL_DIRECTIONS), np.sin(BALL_DIRECTIONS)]) * radius_m * (1.0 + share)
        return np.concatenate([center[None], *(center + part * circle for part in BALL_SHARES)])

    def _distances(self, points_m: Floats, robots_m: Floats) -> Floats:
        """How far points lie outside of the hulls, negative inside, shape (n, k) [m].

        The nearest circle between foot and top is the one whose tangent's normal goes through the point.
        """
        shadow = (robots_m - self._eye[:2]) * self._stretch
        length = np.hypot(shadow[:, 0], shadow[:, 1])
        unit = self._outward(robots_m)
        offset = points_m[:, None] - robots_m
        along = offset[..., 0] * unit[:, 0] + offset[..., 1] * unit[:, 1]
        aside = np.abs(offset[..., 0] * unit[:, 1] - offset[..., 1] * unit[:, 0])
        slope = np.sqrt(np.maximum(length**2 - self._growth**2, 0.0))
        # below the camera the top's circle contains the foot's: then it alone counts
        ahead = np.where(slope > 0.0, along + aside * self._growth / np.maximum(slope, 1e-12), length)
        part = np.clip(ahead / np.maximum(length, 1e-12), 0.0, 1.0)
        distances: Floats = np.hypot(along - part * length, aside) - self._foot - part * self._growth
        return distances
