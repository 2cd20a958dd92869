"""What stands still: carpet, lines, walls, goals, and the camera with what it sees of the floor."""

import math

import numpy as np
import viser

from app.web.view3d.solids import upright
from vision_core.geometry import Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent, field_segments, goal_line_x, painted_points
from vision_core.settings.schema import FieldSettings, Settings
from vision_core.types.edges import EDGE_TYPES, EdgeKind
from vision_core.types.field import Segment

CARPET_RGB = (46, 110, 62)
PAINT_RGB = (240, 240, 240)
CAMERA_RGB = (230, 150, 40)
CARPET_THICKNESS_M = 0.01
WALL_THICKNESS_M = 0.012
LIMIT_HEIGHT_M = 0.004
"""A limit that is no wall is drawn as a low strip."""
GOAL_HEIGHT_M = 0.16
POINTS_PER_LINE = 48
LIFT_M = 0.001
"""Paint lies this high over the carpet, so that it does not flicker."""
CAMERA_SIZE_M = 0.12
PICTURE_STEPS = 12
"""Points along each side of the picture, since lenses bend it."""


def add_field(scene: viser.SceneApi, field: FieldSettings) -> None:
    """The carpet and what is painted on it."""
    half_x, half_y = accepted_half_extent(field)
    half_x = max(half_x, goal_line_x(field) + field.goal.depth_m)
    corners = np.array([[half_x, half_y], [-half_x, half_y], [-half_x, -half_y], [half_x, -half_y]])
    carpet = upright(corners, -CARPET_THICKNESS_M, 0.0)
    scene.add_mesh_simple(
        "/field/carpet", carpet.vertices_m, carpet.faces, color=CARPET_RGB, flat_shading=True, receive_shadow=False
    )
    lines = painted_points(field, POINTS_PER_LINE)
    if lines:
        pieces = np.concatenate([_pieces(_on_floor(line, LIFT_M)) for line in lines])
        scene.add_line_segments("/field/lines", pieces, PAINT_RGB, thickness=max(field.line_width_m, 0.004))


def add_walls(scene: viser.SceneApi, settings: Settings, blue_defends: str) -> None:
    """Walls, goals and limits in the colors of their edge types; goals change color with the sides."""
    colors = {edge.kind: _rgb(edge.on_dark) for edge in EDGE_TYPES}
    for number, segment in enumerate(field_segments(settings.field, blue_defends)):
        solid = upright(_strip(segment), 0.0, _height_m(segment, settings.field))
        layer = "goals" if segment.kind in (EdgeKind.GOAL_BLUE, EdgeKind.GOAL_YELLOW) else "walls"
        scene.add_mesh_simple(
            f"/field/{layer}/{number}",
            solid.vertices_m,
            solid.faces,
            color=colors[segment.kind],
            flat_shading=True,
            opacity=0.85,
        )


def add_camera(scene: viser.SceneApi, camera: CameraSetup) -> None:
    """The camera at its place, and the part of the floor that it sees."""
    center = np.asarray(camera.model.position_m, dtype=np.float64)
    floor = _on_floor(camera.seen_floor_m(PICTURE_STEPS), LIFT_M)
    name = f"/cameras/{camera.name}"
    scene.add_box(name, CAMERA_RGB, (CAMERA_SIZE_M,) * 3, position=tuple(center))
    if len(floor) < 3:
        return
    edges = [np.stack([center, floor[corner]]) for corner in range(0, len(floor), PICTURE_STEPS)]
    closed = np.vstack([floor, floor[:1]])
    points = np.concatenate([np.stack(edges), _pieces(closed)])
    scene.add_line_segments(f"/cameras/{camera.name} sees", points, CAMERA_RGB, thickness=0.006)


def _pieces(points_m: Floats) -> Floats:
    """The straight pieces between following points, shape (n - 1, 2, 3)."""
    return np.stack([points_m[:-1], points_m[1:]], axis=1)


def _on_floor(points_m: Floats, height_m: float) -> Floats:
    return np.column_stack([points_m, np.full(len(points_m), height_m)])


def _strip(segment: Segment) -> Floats:
    """The outline of a segment with a thickness, on the floor."""
    a, b = np.array([segment.x1_m, segment.y1_m]), np.array([segment.x2_m, segment.y2_m])
    along = (b - a) / max(math.hypot(*(b - a)), 1e-9)
    across = 0.5 * WALL_THICKNESS_M * np.array([-along[1], along[0]])
    return np.array([a + across, a - across, b - across, b + across])


def _height_m(segment: Segment, field: FieldSettings) -> float:
    if segment.kind in (EdgeKind.GOAL_BLUE, EdgeKind.GOAL_YELLOW):
        return GOAL_HEIGHT_M
    return max(field.wall_height_m, LIMIT_HEIGHT_M) if segment.solid else LIMIT_HEIGHT_M


def _rgb(hex_color: str) -> tuple[int, int, int]:
    return int(hex_color[1:3], 16), int(hex_color[3:5], 16), int(hex_color[5:7], 16)
