"""The hot path's data: tables of fixed size, one block of memory each.

A record with lists of objects costs an allocation per object and frame. These tables are allocated once and filled in
place by compiled code; the database copies their bytes without encoding. ``objects``, ``tracks`` and ``views`` define
records with the same content, for code off the hot path: ``record`` makes one from a table, ``of`` a table from one.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision_core.clock import Instant
from vision_core.types.objects import BallSighting, ObstacleSighting, RobotSighting, Sightings, Team
from vision_core.types.tracks import BallTrack, ObstacleTrack, RobotTrack, World
from vision_core.types.views import Views, ViewSnapshot

Table = NDArray[Any]
"""A structured array, or one row of it."""

NO_ID = -1
TEAMS = (Team.BLUE, Team.YELLOW)
"""A team's number in the tables is its index here."""
TEAM_NUMBER = {team: number for number, team in enumerate(TEAMS)}

MAX_ROBOTS = 64
"""Two full teams twice over: a picture that seems to show more is full of false ones."""
MAX_BALLS = 32
MAX_OBSTACLES = 64

BLOB = np.dtype(
    [
        ("color", np.int32), ("area_px", np.int32),
        ("x_px", np.float64), ("y_px", np.float64),
        ("left", np.int32), ("top", np.int32), ("right", np.int32), ("bottom", np.int32),
    ]
)  # fmt: skip
"""A connected region of one color class: class of the ColorTable, area, centroid, bounding box (inclusive)."""

ROBOT = np.dtype(
    [
        ("team", np.int32), ("id", np.int32),
        ("x_px", np.float64), ("y_px", np.float64), ("x_m", np.float64), ("y_m", np.float64),
        ("heading_rad", np.float64), ("confidence", np.float64),
        ("position_sd_m", np.float64), ("heading_sd_rad", np.float64),
    ]
)  # fmt: skip
"""A RobotSighting. Unknown: id NO_ID; heading_rad and heading_sd_rad nan."""

BALL = np.dtype(
    [
        ("x_px", np.float64), ("y_px", np.float64), ("x_m", np.float64), ("y_m", np.float64),
        ("confidence", np.float64), ("position_sd_m", np.float64),
    ]
)  # fmt: skip

OBSTACLE = np.dtype(
    [
        ("x_px", np.float64), ("y_px", np.float64), ("x_m", np.float64), ("y_m", np.float64),
        ("radius_m", np.float64), ("confidence", np.float64),
    ]
)  # fmt: skip

ROBOT_TRACK = np.dtype(
    [
        ("team", np.int32), ("id", np.int32), ("x_m", np.float64), ("y_m", np.float64), ("heading_rad", np.float64),
        ("vx_m_s", np.float64), ("vy_m_s", np.float64), ("turn_rad_s", np.float64),
        ("position_sd_m", np.float64), ("heading_sd_rad", np.float64), ("confidence", np.float64), ("seen", np.int64),
    ]
)  # fmt: skip

BALL_TRACK = np.dtype(
    [
        ("x_m", np.float64), ("y_m", np.float64), ("vx_m_s", np.float64), ("vy_m_s", np.float64),
        ("position_sd_m", np.float64), ("hidden", np.int64), ("seen", np.int64),
    ]
)  # fmt: skip

OBSTACLE_TRACK = np.dtype(
    [
        ("x_m", np.float64), ("y_m", np.float64), ("vx_m_s", np.float64), ("vy_m_s", np.float64),
        ("radius_m", np.float64), ("seen", np.int64),
    ]
)  # fmt: skip

MAX_NUMBERS = 16
"""Robots of a team that can have a number, and so a view."""
DIRECTIONS = 360
"""Directions of the page's views: every whole degree."""

VIEW = np.dtype(
    [
        ("team", np.int32), ("number", np.int32), ("overlap", np.int32), ("partial", np.int32),
        ("ball_px", np.int32), ("ball_direction_deg", np.int32), ("ball_size_deg", np.int32),
        ("px", np.uint8, (DIRECTIONS,)), ("kinds", np.uint8, (DIRECTIONS,)),
    ]
)  # fmt: skip
"""A ``ViewSnapshot``."""
VIEWS = np.dtype(
    [
        ("frame_number", np.int64), ("at", np.int64), ("count", np.int64),
        ("views", VIEW, (len(TEAMS) * MAX_NUMBERS,)),
    ]
)  # fmt: skip

SIGHTINGS = np.dtype(
    [
        ("camera", "S16"), ("frame_number", np.int64), ("grabbed", np.int64), ("perceived", np.int64),
        ("complete", np.int64), ("counts", np.int64, (2,)),
        ("robots", ROBOT, (MAX_ROBOTS,)), ("balls", BALL, (MAX_BALLS,)),
    ]
)  # fmt: skip
WORLD = np.dtype(
    [
        ("frame_number", np.int64), ("at", np.int64), ("counts", np.int64, (3,)),
        ("robots", ROBOT_TRACK, (MAX_ROBOTS,)), ("balls", BALL_TRACK, (1,)),
        ("obstacles", OBSTACLE_TRACK, (MAX_OBSTACLES,)),
    ]
)  # fmt: skip


class _OneRow:
    """A table of one row in its own memory: the form of a record in the hot path and in the database."""

    def __init__(self, kind: np.dtype[Any], memory: bytes | bytearray | memoryview | None) -> None:
        self.whole: Table = np.zeros(1, dtype=kind)
        """The row, shape (1,)."""
        self.bytes: memoryview = self.whole.view(np.uint8).data
        """The memory of ``whole``."""
        if memory is not None:
            self.load(memory)

    def load(self, memory: bytes | bytearray | memoryview) -> None:
        """Copy the bytes of another table of this kind."""
        self.whole.view(np.uint8)[:] = np.frombuffer(memory, dtype=np.uint8)


class SightingsTable(_OneRow):
    """Everything seen in one frame, in the order of ``Sightings``."""

    def __init__(self, memory: bytes | bytearray | memoryview | None = None) -> None:
        """memory: bytes of another table, which are copied; None: a table of zeros."""
        super().__init__(SIGHTINGS, memory)
        row = self.whole[0]
        self.counts: NDArray[np.int64] = row["counts"]
        """Valid rows of ``robots`` and ``balls``."""
        self.robots: Table = row["robots"]
        self.balls: Table = row["balls"]

    def stamp(self, camera: str, frame_number: int, grabbed: Instant, perceived: Instant) -> None:
        """Set camera, number, grab instant and perception instant of the frame."""
        row = self.whole[0]
        row["camera"], row["frame_number"] = camera.encode(), frame_number
        row["grabbed"], row["perceived"] = grabbed, perceived

    def record(self) -> Sightings:
        """The content as a record."""
        row = self.whole[0]
        robots, balls = self.counts.tolist()
        return Sightings(
            camera=row["camera"].decode(),
            frame_number=int(row["frame_number"]),
            grabbed=Instant(int(row["grabbed"])),
            perceived=Instant(int(row["perceived"])),
            robots=tuple(_robot(robot) for robot in self.robots[:robots].tolist()),
            balls=tuple(BallSighting(*ball) for ball in self.balls[:balls].tolist()),
            complete=bool(row["complete"]),
        )

    @classmethod
    def of(cls, seen: Sightings) -> "SightingsTable":
        """The content of a record as a table."""
        table = cls()
        table.stamp(seen.camera, seen.frame_number, seen.grabbed, seen.perceived)
        table.whole["complete"] = seen.complete
        table.counts[:] = len(seen.robots), len(seen.balls)
        for index, robot in enumerate(seen.robots):
            table.robots[index] = (
                TEAM_NUMBER[robot.team], NO_ID if robot.id is None else robot.id,
                robot.x_px, robot.y_px, robot.x_m, robot.y_m,
                np.nan if robot.heading_rad is None else robot.heading_rad, robot.confidence, robot.position_sd_m,
                np.nan if robot.heading_sd_rad is None else robot.heading_sd_rad,
            )  # fmt: skip
        for index, ball in enumerate(seen.balls):
            table.balls[index] = (ball.x_px, ball.y_px, ball.x_m, ball.y_m, ball.confidence, ball.position_sd_m)
        return table


class WorldTable(_OneRow):
    """The field at one instant, in the order of ``World``."""

    def __init__(self, memory: bytes | bytearray | memoryview | None = None) -> None:
        """memory: bytes of another table, which are copied; None: a table of zeros."""
        super().__init__(WORLD, memory)
        row = self.whole[0]
        self.counts: NDArray[np.int64] = row["counts"]
        """Valid rows of ``robots``, ``balls`` (0 or 1) and ``obstacles``."""
        self.robots: Table = row["robots"]
        self.balls: Table = row["balls"]
        self.obstacles: Table = row["obstacles"]

    def record(self) -> World:
        """The content as a record."""
        row = self.whole[0]
        robots, balls, obstacles = self.counts.tolist()
        return World(
            frame_number=int(row["frame_number"]),
            at=Instant(int(row["at"])),
            robots=tuple(_robot_track(track) for track in self.robots[:robots].tolist()),
            ball=_ball_track(self.balls[0].tolist()) if balls else None,
            obstacles=tuple(_obstacle_track(track) for track in self.obstacles[:obstacles].tolist()),
        )

    @classmethod
    def of(cls, world: World) -> "WorldTable":
        """The content of a record as a table."""
        table = cls()
        row = table.whole[0]
        row["frame_number"], row["at"] = world.frame_number, world.at
        table.counts[:] = len(world.robots), world.ball is not None, len(world.obstacles)
        for index, robot in enumerate(world.robots):
            table.robots[index] = (
                TEAM_NUMBER[robot.team], NO_ID if robot.id is None else robot.id,
                robot.x_m, robot.y_m, robot.heading_rad, robot.vx_m_s, robot.vy_m_s, robot.turn_rad_s,
                robot.position_sd_m, robot.heading_sd_rad, robot.confidence, robot.seen,
            )  # fmt: skip
        if (ball := world.ball) is not None:
            table.balls[0] = (
                ball.x_m, ball.y_m, ball.vx_m_s, ball.vy_m_s, ball.position_sd_m, ball.hidden, ball.seen
            )  # fmt: skip
        for index, obstacle in enumerate(world.obstacles):
            table.obstacles[index] = (
                obstacle.x_m, obstacle.y_m, obstacle.vx_m_s, obstacle.vy_m_s, obstacle.radius_m, obstacle.seen
            )  # fmt: skip
        return table


class ViewsTable(_OneRow):
    """The views of all robots for the page, in the pixels of its team's mirror."""

    def __init__(self, memory: bytes | bytearray | memoryview | None = None) -> None:
        """memory: bytes of another table, which are copied; None: a table of zeros."""
        super().__init__(VIEWS, memory)

    def record(self) -> Views:
        """The content as a record."""
        row = self.whole[0]
        views = row["views"][: int(row["count"])].tolist()
        return Views(int(row["frame_number"]), Instant(int(row["at"])), tuple(_view(view) for view in views))

    @classmethod
    def of(cls, views: Views) -> "ViewsTable":
        """The content of a record as a table."""
        table = cls()
        row = table.whole[0]
        row["frame_number"], row["at"], row["count"] = views.frame_number, views.at, len(views.views)
        for index, view in enumerate(views.views):
            row["views"][index] = (
                TEAM_NUMBER[view.team], view.number, view.overlap, view.partial,
                view.ball_px, view.ball_direction_deg, view.ball_size_deg, list(view.px), list(view.kinds),
            )  # fmt: skip
        return table


def obstacle_table(obstacles: tuple[ObstacleSighting, ...]) -> Table:
    """The content of records as a table: OBSTACLE, shape (n,)."""
    rows = [(o.x_px, o.y_px, o.x_m, o.y_m, o.radius_m, o.confidence) for o in obstacles]
    return np.array(rows, dtype=OBSTACLE)


def _none_for_nan(number: float) -> float | None:
    return None if np.isnan(number) else number


def _robot(row: tuple[Any, ...]) -> RobotSighting:
    team, marker, x_px, y_px, x_m, y_m, heading, confidence, position_sd, heading_sd = row
    return RobotSighting(
        team=TEAMS[team], id=None if marker == NO_ID else marker, x_px=x_px, y_px=y_px, x_m=x_m, y_m=y_m,
        heading_rad=_none_for_nan(heading), confidence=confidence, position_sd_m=position_sd,
        heading_sd_rad=_none_for_nan(heading_sd),
    )  # fmt: skip


def _robot_track(row: tuple[Any, ...]) -> RobotTrack:
    team, marker, x, y, heading, vx, vy, turn, position_sd, heading_sd, confidence, seen = row
    known = None if marker == NO_ID else marker
    return RobotTrack(
        TEAMS[team], known, x, y, heading, vx, vy, turn, position_sd, heading_sd, confidence, Instant(seen)
    )


def _ball_track(row: tuple[Any, ...]) -> BallTrack:
    x, y, vx, vy, position_sd, hidden, seen = row
    return BallTrack(x, y, vx, vy, position_sd, bool(hidden), Instant(seen))


def _obstacle_track(row: tuple[Any, ...]) -> ObstacleTrack:
    x, y, vx, vy, radius, seen = row
    return ObstacleTrack(x, y, vx, vy, radius, Instant(seen))


def _view(row: tuple[Any, ...]) -> ViewSnapshot:
    team, number, overlap, partial, ball_px, direction_deg, size_deg, px, kinds = row
    return ViewSnapshot(
        TEAMS[team], number, bytes(px), bytes(kinds), ball_px, direction_deg, size_deg, bool(partial), bool(overlap)
    )
