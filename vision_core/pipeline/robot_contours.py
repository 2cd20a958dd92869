"""The contours of both teams' robots under one camera: what they cover, and whether the ball may be hidden there."""

from collections.abc import Sequence

import numpy as np

from vision_core.geometry import Floats, Mask
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.from_settings import robots_of
from vision_core.regions.body_contours import HIDDEN_SHARE, BodySilhouettes
from vision_core.settings.schema import Settings
from vision_core.types.objects import RobotSighting, Team
from vision_core.types.regions import BallVisibility, BodyContour, BodyContours

MOVED_M = 0.03
"""Added to the robots' radius where sightings and picture may be some milliseconds apart."""
SQUARE = 2.0**0.5
"""Half the diagonal of a square robot, in halves of its side: its heading is not looked at."""


class RobotContours:
    """Knows the size of each team's robots. Holds no state."""

    def __init__(self, settings: Settings, camera: CameraSetup) -> None:
        self._camera, self._ball_radius_m = camera, settings.ball.radius_m
        self._silhouettes = {}
        for team in Team:
            robots = robots_of(settings.robots, team)
            radius_m = robots.radius_m * (SQUARE if robots.outline == "square" else 1.0)
            self._silhouettes[team] = BodySilhouettes(camera.model.position_m, radius_m, robots.height_m)

    def covered(self, points_m: Floats, robots: Sequence[RobotSighting]) -> Mask:
        """Which points of the floor some robot covers. points_m: shape (n, 2); returns shape (n,)."""
        covered = np.zeros(len(points_m), dtype=np.bool_)
        for team, silhouettes in self._silhouettes.items():
            covered |= silhouettes.covered(points_m, _places(robots, team), MOVED_M)
        return covered

    def of(self, robots: Sequence[RobotSighting]) -> tuple[BodyContour, ...]:
        """The contours of the robots of one frame, the blue ones first."""
        contours = []
        for team, silhouettes in self._silhouettes.items():
            places = _places(robots, team)
            outlines = silhouettes.outlines(places)
            seen = self._camera.model.pixel_from_field(outlines.reshape(-1, 2)).reshape(outlines.shape)
            hides = silhouettes.can_hide(self._ball_radius_m, places)
            own = (robot for robot in robots if robot.team == team)
            contours += [
                BodyContour(team, robot.id, _points(outline.round(4)), _points(pixels.round(1)), bool(can_hide))
                for robot, outline, pixels, can_hide in zip(own, outlines, seen, hides, strict=True)
            ]
        return tuple(contours)

    def found(
        self, robots: Sequence[RobotSighting], *, is_ball_seen: bool, ball_m: tuple[float, float] | None
    ) -> BodyContours:
        """The contours of the robots of one frame, and what they say about the ball.

        ball_m: where the ball should be; None when that is not known.
        """
        hiding, hidden = [], 0.0
        for team, silhouettes in self._silhouettes.items() if ball_m is not None else ():
            places, ball = _places(robots, team), np.array(ball_m)
            hidden = max(hidden, silhouettes.hidden_share(ball, self._ball_radius_m, places))
            covers = silhouettes.hiding(ball, self._ball_radius_m, places)
            own = (robot for robot in robots if robot.team == team)
            hiding += [(team, robot.id) for robot, is_in_front in zip(own, covers, strict=True) if is_in_front]
        return BodyContours(self.of(robots), self._verdict(is_ball_seen, ball_m, hidden), ball_m, tuple(hiding))

    def _verdict(self, is_seen: bool, ball_m: tuple[float, float] | None, hidden: float) -> BallVisibility:
        if is_seen:
            return BallVisibility.SEEN
        if ball_m is None:
            return BallVisibility.UNKNOWN
        (pixel,) = self._camera.model.pixel_from_field(np.array([ball_m]), self._ball_radius_m)
        width, height = self._camera.size_px
        if not (0.0 <= pixel[0] < width and 0.0 <= pixel[1] < height):
            return BallVisibility.OUT_OF_PICTURE
        return BallVisibility.MAY_BE_HIDDEN if hidden > HIDDEN_SHARE else BallVisibility.GONE


def _places(robots: Sequence[RobotSighting], team: Team) -> Floats:
    """Where the robots of a team are, shape (k, 2) [m]."""
    return np.array([(robot.x_m, robot.y_m) for robot in robots if robot.team == team]).reshape(-1, 2)


def _points(points: Floats) -> tuple[tuple[float, float], ...]:
    return tuple((x, y) for x, y in points.tolist())
