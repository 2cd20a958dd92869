"""The on-board camera's first hits once more, in NumPy and without compiled code: all pixels at a time, solid by solid.

The rays start at the mirror's points and not at the viewpoint, and every outline is clipped as an intersection of
half-spaces, so that little is shared with what it checks.
"""

import math

import numpy as np

from vision_core.geometry import Floats, rotation
from vision_core.onboard.camera import OnboardCamera
from vision_core.onboard.ray_tracer import BALL, FLOOR, OUTSIDE, ROOM, Labels
from vision_core.onboard.scene import Scene
from vision_core.types.tables import Table

SIDES = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
"""Outward normals of a box."""
TIE_M = 1e-9


def first_hits(camera: OnboardCamera, scene: Scene) -> tuple[Labels, Floats]:
    """Labels and ranges of every pixel's center, as ``OnboardCamera.labels``."""
    width, height = camera.size_px
    forward, left = np.meshgrid(
        0.5 * (height - 1) - np.arange(height), 0.5 * (width - 1) - np.arange(width), indexing="ij"
    )
    forward, left = forward / camera.scale, left / camera.scale
    inside = forward**2 + left**2 <= camera.rim_px**2
    ray = np.stack(camera.shape.rays_from_px(forward[inside], left[inside]))
    turn = rotation(float(scene.viewer[2]))
    start = np.vstack([turn @ ray[:2] + scene.viewer[:2, None], ray[2:3] + scene.height_m - camera.shape.c_m])
    along = np.vstack([turn @ ray[3:5], ray[5:]])
    nearest, found = np.full(start.shape[1], np.inf), np.full(start.shape[1], ROOM)
    candidates = [(row, _solid_hits(solid, start, along)) for row, solid in enumerate(scene.solids)]
    candidates += [(BALL, _ball_hits(scene.ball, start, along)), (FLOOR, _plane_hits(start[2], along[2]))]
    for axis in range(2):
        ahead = np.sign(along[axis]) * scene.ground.room[axis] - start[axis]
        candidates.append((ROOM, _plane_hits(-ahead, along[axis])))
    for label, distances in candidates:
        nearer = distances < nearest - TIE_M
        nearest[nearer], found[nearer] = distances[nearer], label
    eye = np.array([*scene.viewer[:2], scene.height_m])[:, None]
    labels, ranges = np.full((height, width), OUTSIDE, dtype=np.int32), np.full((height, width), np.inf)
    labels[inside], ranges[inside] = found, np.linalg.norm(start + nearest * along - eye, axis=0)
    return labels, ranges


def _solid_hits(solid: Table, start: Floats, along: Floats) -> Floats:
    """Distances along rays, shape (3, n), to an upright prism; inf for a miss."""
    to_own = rotation(-float(solid["heading_rad"]))
    o, d = to_own @ (start[:2] - np.array([[solid["x_m"]], [solid["y_m"]]])), to_own @ along[:2]
    if solid["round"]:
        a, b = (d * d).sum(axis=0), (o * d).sum(axis=0)
        room = b * b - a * ((o * o).sum(axis=0) - solid["half_length_m"] ** 2)
        root = np.where(room > 0.0, np.sqrt(np.maximum(room, 0.0)), np.nan)
        enter, leave = (-b - root) / a, (-b + root) / a
        faces = [(np.array([1.0, 0.0]), solid["front_m"])] if math.isfinite(solid["front_m"]) else []
    else:
        enter, leave = np.full(o.shape[1], -np.inf), np.full(o.shape[1], np.inf)
        halves = (solid["half_length_m"], solid["half_length_m"], solid["half_width_m"], solid["half_width_m"])
        faces = list(zip(SIDES, halves, strict=True))
    spaces = [(normal @ o - limit, normal @ d) for normal, limit in faces]
    spaces += [(start[2] - solid["top_m"], along[2]), (solid["bottom_m"] - start[2], -along[2])]
    for above, rate in spaces:  # inside of a half-space is where above + t rate < 0
        at = -above / rate
        enter, leave = (
            np.where(rate < 0.0, np.maximum(enter, at), enter),
            np.where(rate > 0.0, np.minimum(leave, at), leave),
        )
    return np.where((enter < leave) & (enter > 0.0), enter, np.inf)


def _ball_hits(ball: Floats, start: Floats, along: Floats) -> Floats:
    """Distances along rays to the ball; inf for a miss."""
    o = start - np.array([[ball[0]], [ball[1]], [ball[4]]])
    b = (o * along).sum(axis=0)
    room = b * b - (o * o).sum(axis=0) + ball[4] ** 2
    return np.where(room > 0.0, -b - np.sqrt(np.maximum(room, 0.0)), np.inf)


def _plane_hits(above: Floats, rate: Floats) -> Floats:
    """Distances along rays to the plane where a coordinate, now above, becomes 0; inf for never."""
    t = -above / rate
    return np.where(t > 0.0, t, np.inf)
