"""The fifth to seventh stage composed: sightings in, every robot's view and its datagram out.

Without sockets, processes or clocks, so that tests and benchmarks use the same code as the service.
"""

from dataclasses import dataclass

import msgspec
import numpy as np

from vision_core.clock import Instant
from vision_core.geometry import Floats, frozen
from vision_core.protocol.letters import LetterTable
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.protocol.see import ball_from_view, edge_px, see_from_view
from vision_core.rtdb.records import Views, ViewSnapshot
from vision_core.settings import Settings
from vision_core.settings_models import mirror_from
from vision_core.tracks.tracker import Tracker
from vision_core.types.objects import Sightings, Team
from vision_core.types.tracks import World
from vision_core.types.views import RobotView
from vision_core.views.observe import Observer


@dataclass(frozen=True, slots=True)
class Scene:
    """One frame, seen by everybody."""

    world: World
    views: dict[tuple[Team, int], RobotView]
    """All-round views at one degree of every robot that has a number and is in the world."""


class SceneMaker:
    """Tracks, observes and encodes. Holds the tracks and nothing else that changes."""

    def __init__(self, settings: Settings, boot: Instant) -> None:
        self._tracker = Tracker(settings.tracks)
        self._observer = Observer(settings.field, settings.robots, settings.ball, settings.views, settings.match)
        self._numbers = settings.match.numbers
        self._mirror = mirror_from(settings)
        self._letters = LetterTable(**msgspec.structs.asdict(settings.protocol.letters))
        self._boot = boot
        self._rays: dict[int, Floats] = {}

    def scene(self, sightings: Sightings) -> Scene:
        """Take in a frame; returns the world at its grab instant and what its robots see."""
        world = self._tracker.update(sightings)
        views = {}
        for team in Team:
            for number in range(1, self._numbers + 1):
                view = self._observer.observe(world, team, number)
                if view is not None:
                    views[team, number] = view
        return Scene(world, views)

    def datagram(self, scene: Scene, team: Team, number: int, options: Options, *, nul: bool) -> bytes | None:
        """The ``see`` of one client; None when its robot is not in the world."""
        view = scene.views.get((team, number))
        if view is not None and len(view.kinds) != options.rays_per_circle:
            view = self._observer.observe(scene.world, team, number, self._directions(options.rays_per_circle))
        if view is None:
            return None
        return see_from_view(view, options, self._mirror, self._letters, self._boot, nul=nul)

    def snapshot(self, scene: Scene) -> Views:
        """The views for the page, in the pixels of the field's mirror."""
        return Views(
            scene.world.frame_number,
            scene.world.at,
            tuple(self._snapshot(view) for view in scene.views.values()),
        )

    def _snapshot(self, view: RobotView) -> ViewSnapshot:
        ball = ball_from_view(view.ball, PAPER_OPTIONS, self._mirror)
        return ViewSnapshot(
            team=view.team,
            number=view.number,
            px=edge_px(view, self._mirror).tobytes(),
            kinds=view.kinds.tobytes(),
            ball_px=ball.px,
            ball_direction_deg=ball.direction_deg,
            ball_size_deg=ball.size_deg,
            partial=view.ball is not None and view.ball.partial,
            overlap=view.overlap,
        )

    def _directions(self, rays: int) -> Floats:
        """Evenly spaced rays over the circle [deg]."""
        if rays not in self._rays:
            self._rays[rays] = frozen(np.linspace(0.0, 360.0, rays, endpoint=False))
        return self._rays[rays]
