"""A snapshot of the simulated world as one robot's on-board camera has it around: solids, ball, floor and light.

Robots have the height of their pattern's settings, its patches on the top, and a band in their team's color round the
side: an on-board camera at the height of the robots does not see their tops, so leagues with on-board vision ask for
colors that are seen from the side.

The viewer's own body is a chassis that is low enough to see the floor from NEAREST_RADII on, as the
paper's robot does, and the camera's housing under the mirror. What holds the mirror is transparent.
"""

import math
from typing import NamedTuple

import numpy as np

from vision_core.capture.synthetic.background import clutter_of, painted_lines, venue_of
from vision_core.capture.synthetic.bodies import VX, VY, X, Y, no_bodies
from vision_core.capture.synthetic.floor import COLORS, Venue
from vision_core.capture.synthetic.render import BODY_BGR, PLATE_BGR, paint_bgr, prisms_of_feet, robot_prism
from vision_core.capture.synthetic.sprites import Prism
from vision_core.capture.synthetic.world import Snapshot
from vision_core.geometry import Floats
from vision_core.models.field import field_segments
from vision_core.onboard.mirror_shape import MirrorShape
from vision_core.onboard.solids import boards, prism_solid
from vision_core.patterns.worn import worn_patterns
from vision_core.settings.schema import Settings
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.tables import Table
from vision_core.views.renderer import FIRST_KIND

BAND = (0.35, 0.80)
"""From where to where the band in the team's color reaches, as shares of the robot's height."""
NEAREST_RADII = 110.0 / 90.0
"""The nearest floor that is seen is so many times farther away than the rim of the robot: 110 mm of 90 mm."""
HOUSING_RADII = 12.0 / 90.0
"""Radius of the camera's housing, in the robot's radii: 12 mm of 90 mm."""
LENS_SHARE, LENS_BGR = 0.45, (96.0, 70.0, 58.0)
"""The lens in the housing: its radius as a share of the housing's, and its color."""
ROOM_M = 2.0
"""The room's walls stand so far outside the field's limit."""
ROOM_BGR = (128.0, 138.0, 142.0)


class Ground(NamedTuple):
    """What does not change from snapshot to snapshot: floor, light and room."""

    venue: Venue
    lines: Floats
    """x1, y1, x2, y2 [m], shape (n, 4)."""
    arcs: Floats
    """x, y, radius, start, end, shape (m, 5)."""
    clutter: Floats
    """Shape (k, CLUTTER_COLUMNS)."""
    colors: Floats
    """Of the floor's materials, shape (8, 3)."""
    room: Floats
    """Half length and half width of the room [m], then its walls' blue, green, red; shape (5,)."""
    brightness: float
    uneven_light: float


class Papers(NamedTuple):
    """The patches on the tops of all solids."""

    patches: Floats
    """As in ``Prism``, shape (p, 5)."""
    bgr: Floats
    """Shape (p, 3)."""
    corners: Floats
    """Shape (c, 2)."""


class Scene(NamedTuple):
    """Everything that the rays of one picture can meet."""

    viewer: Floats
    """The viewer's body: a row as in ``physics``."""
    height_m: float
    """Of the viewpoint over the floor."""
    solids: Table
    """SOLID, shape (n,)."""
    papers: Papers
    ball: Floats
    """x, y, vx, vy, radius [m, m/s], blue, green, red; shape (8,)."""
    shadow_casters: Floats
    """Robots and ball: x, y, vx, vy, radius, height; shape (m, 6)."""
    ground: Ground
    own_parts: int
    """How many solids, the first ones, are the viewer's own."""


class SceneMaker:
    """Makes the scenes that one robot's camera sees. The constructor makes all that snapshots do not change.

    worn: team and marker id of each robot of the snapshots; own: which of them carries the camera. Raises SourceError
    when the pattern has no marker for an id.
    """

    def __init__(self, settings: Settings, worn: tuple[tuple[Team, int], ...], own: int, shape: MirrorShape) -> None:
        self._settings = settings
        self._own = own
        self._height_m = shape.h_m
        venue = venue_of(settings)
        segments = field_segments(settings.field, settings.match.blue_defends)
        self._boards = boards(segments, venue)
        self._ground = _ground(settings, venue)
        patterns = {team: worn_patterns(settings.robots, team) for team in Team}
        self._prisms = [robot_prism(settings, patterns[team], team, marker) for team, marker in worn]
        self._kinds = [_kind_of(settings, team, marker) for team, marker in worn]
        self._bands = [paint_bgr(str(team), f"band of {team}") for team, _ in worn]
        self._own_prisms = _own_body(self._prisms[own], shape)
        standing = [self._own_prisms[0] if place == own else prism for place, prism in enumerate(self._prisms)]
        self._robot_sizes = [(prism.radius, prism.height) for prism in standing]
        chassis = self._own_prisms[0]
        self.nearest_floor_m = chassis.radius * shape.h_m / (shape.h_m - chassis.height)
        """The own chassis hides the floor up to this distance from the robot's center, at a square's corners more."""

    def scene(self, snapshot: Snapshot) -> Scene:
        """The scene of a snapshot."""
        viewer = snapshot.robots[self._own]
        prisms, solids = list(self._own_prisms), []
        for place, prism in enumerate(self._own_prisms):
            solids.append(prism_solid(prism, viewer, EdgeKind.NOTHING))
            solids[-1]["bottom_m"] = self._own_prisms[place - 1].height if place else 0.0
        for place, body in enumerate(snapshot.robots):
            if place != self._own:
                prisms.append(self._prisms[place])
                solids.append(self._robot(place, body))
        bodies, foot_prisms = prisms_of_feet(snapshot.feet)
        feet = [prism_solid(prism, body, EdgeKind.UNKNOWN) for prism, body in zip(foot_prisms, bodies, strict=True)]
        table = np.concatenate([*solids, *feet, self._boards])
        papers = _papers(prisms, table)
        ball = self._settings.ball
        color = paint_bgr(ball.color, "ball.color")
        x, y, _, vx, vy, _ = snapshot.ball
        return Scene(
            viewer=viewer.copy(),
            height_m=self._height_m,
            solids=table,
            papers=papers,
            ball=np.array([x, y, vx, vy, ball.radius_m, *color]),
            shadow_casters=np.column_stack(
                [
                    np.vstack([snapshot.robots, snapshot.ball])[:, [X, Y, VX, VY]],
                    [*self._robot_sizes, (ball.radius_m, 2.0 * ball.radius_m)],
                ]
            ),
            ground=self._ground,
            own_parts=len(self._own_prisms),
        )

    def _robot(self, place: int, body: Floats) -> Table:
        prism = self._prisms[place]
        solid = prism_solid(prism, body, self._kinds[place])
        solid["band_low_m"], solid["band_high_m"] = BAND[0] * prism.height, BAND[1] * prism.height
        solid["band_bgr"] = self._bands[place]
        return solid


def snapshot_of(robots: Floats, ball: tuple[float, float]) -> Snapshot:
    """A snapshot of given poses at rest. robots: x, y, heading [m, rad], shape (n, 3); ball: x, y [m]."""
    bodies = no_bodies(len(robots) + 1)
    bodies[:-1, :3] = robots
    bodies[-1, :2] = ball
    return Snapshot(robots=bodies[:-1], ball=bodies[-1], feet=no_bodies(0))


def _own_body(prism: Prism, shape: MirrorShape) -> tuple[Prism, Prism]:
    """Chassis of a robot and, on it, the housing of its camera with the lens on top."""
    chassis_m = min(shape.h_m * (1.0 - 1.0 / NEAREST_RADII), prism.height)
    plain = np.array([PLATE_BGR, BODY_BGR], dtype=np.float64)
    chassis = prism._replace(height=chassis_m, colors=plain, patches=np.empty((0, 5)), corners=np.empty((0, 2)))
    radius = HOUSING_RADII * prism.radius
    lens = np.array([[0.0, 0.0, LENS_SHARE * radius, 0.0, 0.0]])
    dark = np.array([BODY_BGR, BODY_BGR, LENS_BGR], dtype=np.float64)
    return chassis, Prism(radius, math.inf, False, shape.pinhole_m, dark, lens, np.empty((0, 2)))


def _kind_of(settings: Settings, team: Team, marker: int) -> int:
    """EdgeKind code of a robot."""
    ids = settings.match.ids_of(team)
    return FIRST_KIND[team] + (ids.index(marker) + 1 if marker in ids else 0)


def _papers(prisms: list[Prism], solids: Table) -> Papers:
    """The patches of all prisms; fills in which of them each of the first solids has."""
    patches, colors, corners = [np.empty((0, 5))], [np.empty((0, 3))], [np.empty((0, 2))]
    first = first_corner = 0
    for row, prism in zip(solids, prisms, strict=False):
        own = prism.patches.reshape(-1, 5).copy()
        own[:, 3:] += first_corner
        row["first_patch"], row["end_patch"] = first, first + len(own)
        patches.append(own)
        colors.append(prism.colors[2:])
        corners.append(prism.corners)
        first, first_corner = first + len(own), first_corner + len(prism.corners)
    return Papers(np.concatenate(patches), np.concatenate(colors), np.concatenate(corners))


def _ground(settings: Settings, venue: Venue) -> Ground:
    """Floor, light and room. A virtual limit is a painted line, so that the camera can see it."""
    lines, arcs = painted_lines(settings.field)
    limits = [
        (segment.x1_m, segment.y1_m, segment.x2_m, segment.y2_m)
        for segment in field_segments(settings.field, settings.match.blue_defends)
        if not segment.solid
    ]
    if venue.line_half:
        beyond = np.array(limits).reshape(-1, 4)
        lines = np.concatenate([lines, beyond + np.sign(beyond) * venue.line_half])
    return Ground(
        venue=venue,
        lines=lines,
        arcs=arcs,
        clutter=clutter_of(settings, venue),
        colors=COLORS,
        room=np.array([venue.half_x + ROOM_M, venue.half_y + ROOM_M, *ROOM_BGR]),
        brightness=settings.synthetic.brightness,
        uneven_light=settings.synthetic.uneven_light,
    )
