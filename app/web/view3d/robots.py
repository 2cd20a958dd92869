"""Robots as solids that wear their markers."""

from collections.abc import Iterable, Mapping

import numpy as np
import viser

from app.web.view3d.solids import CIRCLE_STEPS, circle_m, flattened, square_m, upright
from vision_core.geometry import Floats
from vision_core.models.from_settings import robots_of
from vision_core.models.mirror import MM_PER_M
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.patterns.pattern import Patch
from vision_core.patterns.worn import pattern_with_id, worn_patterns
from vision_core.settings.schema import Settings, TeamRobotSettings
from vision_core.types.edges import BLUE_RGB, YELLOW_RGB
from vision_core.types.objects import Team
from vision_core.types.tracks import RobotTrack

BODY_RGB = (52, 55, 62)
TEAM_RGB = {Team.BLUE: BLUE_RGB, Team.YELLOW: YELLOW_RGB}
BAND = (0.55, 0.8)
"""The colored band of the team round a body, as shares of its height."""
BAND_THICKNESS_M = 0.0015
PATCH_THICKNESS_M = 0.002
FRONT_SHARE = 55.0 / 90.0
"""Of a round robot: how far its flat front is from its center, as a share of the radius (SSL)."""
Key = tuple[Team, int | None, int]
"""Team, marker id, and the place among the robots whose id cannot be read."""


class Robots3D:
    """One node for each robot that was ever seen; those that are not seen now are hidden."""

    def __init__(self, scene: viser.SceneApi, settings: Settings) -> None:
        self._scene = scene
        self._shapes = {team: robots_of(settings.robots, team) for team in Team}
        self._patterns = {team: worn_patterns(settings.robots, team) for team in Team}
        self._nodes: dict[Key, viser.FrameHandle] = {}

    def show(self, robots: tuple[RobotTrack, ...]) -> None:
        """Move every robot to its place; make those that are new."""
        seen = dict(zip(_keys(robots), robots, strict=True))
        for key, robot in seen.items():
            node = self._nodes.get(key)
            if node is None:
                node = self._nodes[key] = self._made(key)
            node.position = (robot.x_m, robot.y_m, 0.0)
            node.wxyz = turn(robot.heading_rad)
        for key, node in self._nodes.items():
            if node.visible != (key in seen):
                node.visible = key in seen

    def _made(self, key: Key) -> viser.FrameHandle:
        team, marker_id, place = key
        name = f"/robots/{team.value} {f'id {marker_id}' if marker_id is not None else f'unknown {place}'}"
        node = self._scene.add_frame(name, show_axes=False)
        shape = self._shapes[team]
        outline = square_m(shape.radius_m) if shape.outline == "square" else _ssl_outline(shape.radius_m)
        self._add(f"{name}/body", outline, 0.0, shape.height_m - PATCH_THICKNESS_M, BODY_RGB)
        low, high = (share * shape.height_m for share in BAND)
        self._add(f"{name}/band", outline * (1.0 + BAND_THICKNESS_M / shape.radius_m), low, high, TEAM_RGB[team])
        if marker_id is not None:
            self._add_marker(name, team, marker_id, shape)
        return node

    def _add_marker(self, name: str, team: Team, marker_id: int, shape: TeamRobotSettings) -> None:
        if (pattern := pattern_with_id(self._patterns[team], marker_id)) is None:
            return
        outlines = _patch_outlines(pattern.layout(marker_id))
        for number, (outline, color) in enumerate(zip(outlines, pattern.colors_worn(team, marker_id), strict=True)):
            bottom_m = shape.height_m - PATCH_THICKNESS_M
            top_m = shape.height_m + (number + 1) * 1e-4  # patches that overlap must not flicker
            self._add(f"{name}/patch {number}", outline, bottom_m, top_m, _paint(color))

    def _add(self, name: str, outline_m: Floats, bottom_m: float, top_m: float, color: tuple[int, int, int]) -> None:
        solid = upright(outline_m, bottom_m, top_m)
        self._scene.add_mesh_simple(
            name, solid.vertices_m, solid.faces, color=color, flat_shading=len(outline_m) < CIRCLE_STEPS
        )


def turn(angle_rad: float) -> tuple[float, float, float, float]:
    """A turn about the vertical axis as a quaternion w, x, y, z."""
    return float(np.cos(angle_rad / 2.0)), 0.0, 0.0, float(np.sin(angle_rad / 2.0))


def _keys(robots: tuple[RobotTrack, ...]) -> list[Key]:
    unknown: Mapping[Team, list[int]] = {team: [] for team in Team}
    keys: list[Key] = []
    for robot in robots:
        place = 0
        if robot.id is None:
            place = len(unknown[robot.team])
            unknown[robot.team].append(place)
        keys.append((robot.team, robot.id, place))
    return keys


def _ssl_outline(radius_m: float) -> Floats:
    return flattened(circle_m(radius_m), FRONT_SHARE * radius_m)


def _patch_outlines(worn: Iterable[Patch]) -> list[Floats]:
    """The outline of each patch [m]."""
    found = []
    for patch in worn:
        if patch.circle_mm is not None:
            x, y, diameter = (number / MM_PER_M for number in patch.circle_mm)
            found.append(circle_m(diameter / 2.0, (x, y)))
        else:
            assert patch.polygon_mm is not None
            found.append(np.asarray(patch.polygon_mm, dtype=np.float64) / MM_PER_M)
    return found


def _paint(color: str) -> tuple[int, int, int]:
    blue, green, red = PAINTS_BGR.get(color, (128, 128, 128))
    return red, green, blue
