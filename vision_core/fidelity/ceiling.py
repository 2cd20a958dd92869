"""The ceiling's side: from a picture of a world alone what PSLV tells a robot. The truth only scores."""

import math
from typing import NamedTuple

import numpy as np

from vision_core.capture.synthetic.render import Renderer
from vision_core.capture.synthetic.truth import visible_share
from vision_core.capture.synthetic.world import Snapshot, World
from vision_core.clock import NS_PER_S, Instant, ManualClock
from vision_core.fidelity.reports import Report, millimetres, report_of
from vision_core.fidelity.worlds import VIEWER, Setup
from vision_core.geometry import Floats, wrap_angle
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.mirror import Mirror
from vision_core.pipeline.perception import Perception
from vision_core.protocol.options import Options
from vision_core.protocol.see import reference_ball
from vision_core.tracks.tracker import Tracker
from vision_core.types.image import ImageFrame
from vision_core.types.tables import TEAM_NUMBER, WorldTable
from vision_core.views.renderer import GRIDS, ViewRenderer, viewer_index

FRAME_S = 10.0
"""Between two pictures: each is a frame of its own."""
FOUND_M = 0.05
"""A robot is found when a track lies so near."""


class Detection(NamedTuple):
    """How well the ceiling camera saw a world, by the truth."""

    robots_m: Floats
    """Distance of each robot's track of its team from its true place, inf when there is none so near; shape (n,)."""
    viewer_deg: float
    """Error of the viewer's heading."""
    ball_m: float
    """Distance of the ball's track from its true place, inf: none."""
    ball_share: float
    """The share of the ball that the ceiling camera sees."""


class CeilingSide:
    """Sees worlds from the ceiling and tells what the viewer would see, with the functions that the service uses."""

    def __init__(self, setup: Setup, rays: int = GRIDS[0]) -> None:
        self.settings = setup.settings
        self.camera = CameraSetup.from_settings(self.settings)
        self._worn = World(self.settings).robots_worn
        self._renderer = Renderer(self.settings, self.camera, self._worn)
        self._perception = Perception(self.settings, self.camera)
        self._views = ViewRenderer(self.settings)
        self._views.buffers.rays[viewer_index(*VIEWER)] = rays
        self._clock = ManualClock()
        self._frames = 0

    def picture(self, snapshot: Snapshot) -> np.ndarray:
        """The ceiling camera's picture of a world: blue green red, shape (height, width, 3)."""
        pixels = self.camera.black_image()
        self._renderer.draw(pixels, snapshot)
        return pixels

    def world(self, snapshot: Snapshot) -> WorldTable:
        """Where robots and ball are, from the picture alone."""
        self._frames += 1
        grabbed = Instant(round(self._frames * FRAME_S * NS_PER_S))
        frame = ImageFrame(self.camera.name, self._frames, grabbed, self.picture(snapshot))
        sightings = self._perception.perceive_alone(frame, self._clock)
        return Tracker(self.settings.tracks, self.settings.robots).update(sightings)

    def true_world(self, snapshot: Snapshot) -> WorldTable:
        """The same, exactly."""
        table = WorldTable()
        row = table.whole[0]
        row["counts"] = len(self._worn), 1, 0
        for robot, body, (team, marker) in zip(row["robots"], snapshot.robots, self._worn, strict=False):
            robot["team"], robot["id"] = TEAM_NUMBER[team], marker
            robot["x_m"], robot["y_m"], robot["heading_rad"] = body[:3]
        row["balls"][0]["x_m"], row["balls"][0]["y_m"] = snapshot.ball[:2]
        return table

    def report(self, world: WorldTable, mirror: Mirror) -> Report | None:
        """What the viewer is told of a world through a mirror; None when it is not found, so that nothing is sent."""
        self._views.render(world)
        view = self._views.view(world, *VIEWER)
        if view is None:
            return None
        ball = reference_ball(view.ball, Options(), mirror)
        return report_of(view.kinds, millimetres(view.distances_m), mirror, ball)

    def detection(self, world: WorldTable, snapshot: Snapshot) -> Detection:
        """How far a world that was seen is from the truth."""
        row = world.whole[0]
        robots = row["robots"][: row["counts"][0]]
        places = np.column_stack([robots["x_m"], robots["y_m"]])
        away = np.full(len(self._worn), math.inf)
        viewer_deg = math.inf
        own = self._worn.index((VIEWER[0], self.settings.match.blue_ids[VIEWER[1] - 1]))
        for number, (body, (team, _)) in enumerate(zip(snapshot.robots, self._worn, strict=True)):
            distances = np.where(
                robots["team"] == TEAM_NUMBER[team], np.hypot(*(places - body[:2]).T), math.inf
            )  # fmt: skip
            if len(distances) and distances.min() < FOUND_M:
                nearest = int(distances.argmin())
                away[number] = distances[nearest]
                if number == own:
                    viewer_deg = abs(math.degrees(wrap_angle(robots["heading_rad"][nearest] - body[2])))
        ball = row["balls"][0]
        has_ball = row["counts"][1] > 0
        ball_m = math.hypot(ball["x_m"] - snapshot.ball[0], ball["y_m"] - snapshot.ball[1]) if has_ball else math.inf
        return Detection(away, viewer_deg, ball_m, visible_share(snapshot, self.camera, self.settings))
