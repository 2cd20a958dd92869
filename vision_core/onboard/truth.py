"""What a picture of the on-board camera shows, exactly, from the same scene: for scoring what is recognized in it.

In a direction, the nearest solid hides the floor from its foot on. Its side reaches up to its front upper edge, which
is seen where the floor at a greater distance would be; a solid lower than the viewpoint is looked over, and the floor
and what stands on it are seen again beyond its back upper edge.
"""

import math
from dataclasses import dataclass

import numpy as np

from vision_core.capture.synthetic.truth import disc_points
from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.mirror import MM_PER_M
from vision_core.native.kernels import kernel
from vision_core.onboard.azimuths import places_of, shapes_of
from vision_core.onboard.prism_rays import TIE_M, box_interval, hit_prism, outline_interval
from vision_core.onboard.scene import Scene
from vision_core.types.edges import EdgeKind

WALL = int(EdgeKind.WALL)
FOOT, FACE_END, CLEAR, SOLID_NUMBER, KIND = range(5)


@dataclass(frozen=True, slots=True)
class FirstSolids:
    """The nearest edge of every direction as the picture shows it; arrays of shape (n,). Distances are on the floor."""

    kinds: Bytes
    """EdgeKind code; of a robot with its number. NOTHING: the floor goes on to the room's walls."""
    solids: Floats
    """Row in the scene's solids; -1: none, or a virtual limit, which is only a line."""
    foot_mm: Floats
    """Where the edge stands; inf: nothing. Nearer than the camera's ``nearest_floor_m`` the own chassis may hide it."""
    face_end_mm: Floats
    """The front upper edge hides the floor at this distance; inf: it is not lower than the viewpoint."""
    clear_mm: Floats
    """From this distance on the floor is seen over the solid; inf: never."""


def first_solids(scene: Scene, directions_deg: Floats) -> FirstSolids:
    """The nearest edge in directions anticlockwise from the robot's heading, shape (n,), at mid-exposure.

    A robot that stands over the viewpoint's own place is no edge. A virtual limit is one for viewers inside of it.
    """
    angles = np.radians(np.asarray(directions_deg, dtype=np.float64))
    table = np.empty((len(angles), 5))
    _first_solids(table, scene, np.cos(angles), np.sin(angles))
    distances = frozen(table[:, :3].T * MM_PER_M)
    return FirstSolids(
        kinds=frozen(table[:, KIND].astype(np.uint8)),
        solids=frozen(table[:, SOLID_NUMBER].copy()),
        foot_mm=distances[FOOT],
        face_end_mm=distances[FACE_END],
        clear_mm=distances[CLEAR],
    )


@kernel
def _first_solids(table: Floats, scene: Scene, cosines: Floats, sines: Floats) -> None:
    """Fill in FOOT, FACE_END, CLEAR [m], SOLID_NUMBER and KIND of every direction."""
    places, shapes = places_of(scene.solids, scene.viewer, np.zeros(1))[0], shapes_of(scene.solids)
    for k in range(len(cosines)):
        row = table[k]
        row[FOOT], row[FACE_END], row[CLEAR], row[SOLID_NUMBER], row[KIND] = math.inf, math.inf, math.inf, -1.0, 0.0
        for i in range(scene.own_parts, len(scene.solids)):
            solid = scene.solids[i]
            ox, oy, c, s = places[i, 0], places[i, 1], places[i, 2], places[i, 3]
            dx, dy = c * cosines[k] - s * sines[k], s * cosines[k] + c * sines[k]
            enter, leave, _, _ = outline_interval(shapes, i, ox, oy, dx, dy)
            if 0.0 < enter < leave and enter < row[FOOT] - TIE_M:
                low = solid.top_m < scene.height_m
                stretch = scene.height_m / (scene.height_m - solid.top_m) if low else math.inf
                row[FOOT], row[FACE_END], row[CLEAR] = enter, enter * stretch, leave * stretch
                row[SOLID_NUMBER], row[KIND] = i, solid.kind
        limit = _limit_distance(scene, cosines[k], sines[k])
        if limit < row[FOOT]:
            row[FOOT] = row[FACE_END] = row[CLEAR] = limit
            row[SOLID_NUMBER], row[KIND] = -1.0, WALL


@kernel
def _limit_distance(scene: Scene, cosine: float, sine: float) -> float:
    """Distance of the virtual limit in a direction [m]; inf: the field has walls, or the viewer is outside."""
    venue, x, y, heading = scene.ground.venue, scene.viewer[0], scene.viewer[1], scene.viewer[2]
    if venue.walls or abs(x) > venue.half_x or abs(y) > venue.half_y:
        return math.inf
    c, s = math.cos(heading), math.sin(heading)
    _, leave, _, _ = box_interval(
        venue.half_x, venue.half_y, x, y, c * cosine - s * sine, s * cosine + c * sine
    )  # fmt: skip
    return leave


@dataclass(frozen=True, slots=True)
class SeenBall:
    """Where the ball is seen, exactly."""

    distance_mm: float
    """On the floor, from the robot's center to the point on which the ball lies."""
    direction_deg: float
    """Anticlockwise from the heading, 0 <= direction < 360."""
    size_deg: float
    """The full azimuth that it spans; 180: the robot's center is over it."""
    share: float
    """``ball_share``."""


def seen_ball(scene: Scene) -> SeenBall:
    """The ball of a scene at mid-exposure."""
    dx, dy = (scene.ball[:2] - scene.viewer[:2]).tolist()
    distance, radius = math.hypot(dx, dy), float(scene.ball[4])
    direction = math.degrees(math.atan2(dy, dx) - float(scene.viewer[2])) % 360.0
    return SeenBall(
        distance_mm=distance * MM_PER_M,
        direction_deg=0.0 if direction >= 360.0 else direction,  # the remainder of -1e-17 rounds to 360
        size_deg=180.0 if distance <= radius else math.degrees(2.0 * math.asin(radius / distance)),
        share=ball_share(scene),
    )


def ball_share(scene: Scene) -> float:
    """The share of the ball's disc, as the viewpoint sees it, that no solid hides, 0..1; at mid-exposure."""
    eye = np.array([*scene.viewer[:2], scene.height_m])
    points = disc_points(scene.ball[:2], scene.ball[4], eye) - eye
    c, s = math.cos(scene.viewer[2]), math.sin(scene.viewer[2])
    in_robot = np.column_stack([c * points[:, 0] + s * points[:, 1], c * points[:, 1] - s * points[:, 0], points[:, 2]])
    return _clear_share(scene, in_robot)


@kernel
def _clear_share(scene: Scene, points: Floats) -> float:
    """The share of points, given from the viewpoint in robot space, shape (n, 3), that no solid hides."""
    places, shapes = places_of(scene.solids, scene.viewer, np.zeros(1))[0], shapes_of(scene.solids)
    clear = 0
    for k in range(len(points)):
        hidden = False
        for i in range(len(scene.solids)):
            ox, oy, c, s = places[i, 0], places[i, 1], places[i, 2], places[i, 3]
            dx, dy = c * points[k, 0] - s * points[k, 1], s * points[k, 0] + c * points[k, 1]
            t, _, _, _ = hit_prism(shapes, i, scene.height_m, ox, oy, dx, dy, points[k, 2])
            hidden = hidden or t < 1.0
        clear += 0 if hidden else 1
    return clear / len(points)
