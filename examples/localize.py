"""Upper level 2: self-localization. Where the robot is on the known field, by matching the edges that it sees.

    python examples/localize.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]

The walls of the field are lines at known places. The pose in which the seen walls lie best on them is found by
Gauss-Newton steps from the last pose; at first, or when the match is bad, from many poses. The goals tell which way
round. Poses are in the team's own field: its goal at the left, x towards the other goal.
"""

import math
import sys
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vision_core.client import Robot, View, connect

Floats = npt.NDArray[np.float64]
GOALS = {"blue": ("u", "v"), "yellow": ("v", "u")}
"""Letters of the own and the other goal."""
STEPS = 6
OUTLIER_M = 0.15
BAD_M = 0.06
"""A worse fit is begun anew."""
HEADINGS = 24
GRID_M = 0.35


class Pose(NamedTuple):
    """Where the robot is in its team's field, and how well the walls lie on those of the field."""

    x_m: float
    y_m: float
    heading_rad: float
    fit_m: float


class Localizer:
    """Keeps the pose of one robot."""

    def __init__(self, robot: Robot) -> None:
        self._half = np.array(robot.field_m) / 2.0
        self._own, self._other = GOALS[robot.team]
        self.pose: Pose | None = None

    def update(self, view: View) -> Pose | None:
        """The pose in a view; None while too little is seen."""
        walls = view.points_m[view.letters == "w"]
        goals = view.points_m[view.letters == self._own], view.points_m[view.letters == self._other]
        if len(walls) < 20:
            return None
        if self.pose is not None:
            self.pose = self._refined(self.pose, walls)
        if self.pose is None or self.pose.fit_m > BAD_M or self._misfit_of_goals(self.pose, goals) > self._half[0]:
            begun = min(self._starts(), key=lambda pose: self._cost(pose, walls, goals))
            self.pose = self._refined(begun, walls)
        return self.pose

    def _starts(self) -> list[Pose]:
        """Poses all over the field."""
        xs, ys = (np.arange(-half + GRID_M / 2.0, half, GRID_M).tolist() for half in self._half)
        headings = (np.arange(HEADINGS) * (math.tau / HEADINGS)).tolist()
        return [Pose(x, y, heading, math.inf) for x in xs for y in ys for heading in headings]

    def _cost(self, pose: Pose, walls: Floats, goals: tuple[Floats, Floats]) -> float:
        distances, _ = self._to_walls(placed(pose, walls[::4]))
        return float(np.minimum(np.abs(distances), OUTLIER_M).mean()) + 0.2 * self._misfit_of_goals(pose, goals)

    def _misfit_of_goals(self, pose: Pose, goals: tuple[Floats, Floats]) -> float:
        """How far the middles of the seen goals are from where they stand."""
        misfit = 0.0
        for side, points in zip((-1.0, 1.0), goals, strict=True):
            if len(points):
                x, y = placed(pose, points).mean(axis=0)
                misfit += math.hypot(x - side * self._half[0], y)
        return misfit

    def _to_walls(self, points: Floats) -> tuple[Floats, Floats]:
        """Signed distance of points to their nearest wall, and its normal, shapes (n,), (n, 2)."""
        beyond = np.column_stack([points - self._half, -points - self._half])  # of the walls +x, +y, -x, -y
        nearest = np.abs(beyond).argmin(axis=1)
        normals = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
        return beyond[np.arange(len(points)), nearest], normals[nearest]

    def _refined(self, pose: Pose, walls: Floats) -> Pose:
        """The pose after Gauss-Newton steps; near walls count more, since far ones are seen coarsely."""
        weights = 1.0 / (0.3 + np.hypot(*walls.T)) ** 2
        for _ in range(STEPS):
            points = placed(pose, walls)
            distances, normals = self._to_walls(points)
            kept = np.abs(distances) < OUTLIER_M
            if kept.sum() < 10:
                break
            arms = points - (pose.x_m, pose.y_m)
            turned = normals[:, 1] * arms[:, 0] - normals[:, 0] * arms[:, 1]
            slopes = np.column_stack([normals, turned])[kept] * np.sqrt(weights[kept, None])
            dx, dy, turn = np.linalg.lstsq(slopes, -distances[kept] * np.sqrt(weights[kept]), rcond=None)[0].tolist()
            fit_m = float(np.average(np.abs(distances[kept]), weights=weights[kept]))
            pose = Pose(pose.x_m + dx, pose.y_m + dy, pose.heading_rad + turn, fit_m)
        return pose


def placed(pose: Pose, points: Floats) -> Floats:
    """Points of the robot's frame in the field."""
    c, s = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + np.array([pose.x_m, pose.y_m]))


def main(team: str = "blue", number: str = "3", host: str = "127.0.0.1", port: str = "6000", views: str = "90") -> None:
    """Print where a robot is."""
    with connect(host, int(port), team, int(number)) as connection:
        localizer = Localizer(connection.robot)
        for _, view in zip(range(int(views)), connection, strict=False):
            print(f"{view.time_s:.3f} s: {localizer.update(view)}")


if __name__ == "__main__":
    main(*sys.argv[1:])
