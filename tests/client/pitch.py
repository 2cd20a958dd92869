"""A simulated match in virtual time, in which controllers drive robots by their views: no sockets and no pictures.

The views are rendered from the truth, so a controller is tested without what a camera adds.
"""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace

from tests.protocol.samples import CODES
from vision_core.capture.synthetic.world import Snapshot, World
from vision_core.client.driving import Robot
from vision_core.client.play.controllers import Controller, ControllerKind, options_of
from vision_core.client.view import View, view_from_see
from vision_core.clock import NS_PER_S, Instant
from vision_core.models.from_settings import mirrors_of
from vision_core.protocol.answers import decode_message
from vision_core.protocol.driving import Drive, DriveLimits
from vision_core.protocol.messages import See
from vision_core.protocol.options import Options
from vision_core.protocol.see import reference_see
from vision_core.types.drives import no_drives
from vision_core.types.objects import Team
from vision_core.types.tables import TEAM_NUMBER, WorldTable
from vision_core.types.tracks import BallTrack, RobotTrack
from vision_core.types.tracks import World as Tracks
from vision_core.venues.loader import load_settings
from vision_core.views.renderer import ViewRenderer, nearest_m

RATE_HZ = 30.0
PERIOD_S = 1.0 / RATE_HZ
BOOT = Instant(NS_PER_S)
Place = tuple[Team, int]


class Pitch:
    """The world, and the controllers of some of its robots."""

    def __init__(self, kinds: Mapping[Place, ControllerKind], *, late: int = 0, **options: object) -> None:
        """late: by how many frames the controllers get their views late. options: settings, "synthetic__seed"."""
        self.settings = load_settings(options={key.replace("__", "."): value for key, value in options.items()})
        self.world = World(self.settings)
        self.controllers: dict[Place, Controller] = {place: kind(self.robot(place)) for place, kind in kinds.items()}
        self._options = {place: options_of(kind) for place, kind in kinds.items()}
        self._renderer = ViewRenderer(self.settings)
        self._mirrors = mirrors_of(self.settings.mirror)
        self._drives = no_drives()
        self._waiting: deque[dict[Place, View]] = deque()
        self._late = late
        self._frame = 0

    @property
    def now(self) -> Instant:
        return Instant(BOOT + round(self._frame * PERIOD_S * NS_PER_S))

    def index(self, place: Place) -> int:
        """The robot's row in the snapshots."""
        team, number = place
        ids = self.settings.match.blue_ids if team is Team.BLUE else self.settings.match.yellow_ids
        return self.world.robots_worn.index((team, ids[number - 1]))

    def play(self, duration_s: float, watch: Callable[[Snapshot], object] = lambda _: None) -> None:
        """Let time pass; watch: is shown the truth of every frame."""
        for _ in range(round(duration_s * RATE_HZ)):
            self.step()
            watch(self.world.snapshot())

    def step(self) -> dict[Place, View]:
        """One frame; returns the views that the controllers were given."""
        self._waiting.append({place: self.view(place, self._options[place]) for place in self.controllers})
        given = self._waiting.popleft() if len(self._waiting) > self._late else {}
        for place, view in given.items():
            aged = replace(view, age_s=self._late * PERIOD_S, age_bound_s=0.0)
            self._command(place, self.controllers[place].decide(aged))
        self.world.drive(self._drives, self.settings.match, self.now)
        self.world.advance(PERIOD_S)
        self._frame += 1
        return given

    def view(self, place: Place, options: Options = Options()) -> View:  # noqa: B008 (frozen)
        """What a robot sees now."""
        snapshot, at = self.world.snapshot(), self.now
        robots = tuple(
            _track(team, worn, body.tolist(), at)
            for (team, worn), body in zip(self.world.robots_worn, snapshot.robots, strict=True)
        )
        x, y, _, vx, vy, _ = snapshot.ball.tolist()
        table = WorldTable.of(Tracks(self._frame, at, robots, BallTrack(x, y, vx, vy, 0.001, False, at), ()))
        self._renderer.render(table)
        seen = self._renderer.view(table, *place)
        assert seen is not None
        see = decode_message(reference_see(seen, options, self._mirrors[place], CODES, BOOT))
        assert isinstance(see, See)
        return view_from_see(see, options, self._mirrors[place])

    def _command(self, place: Place, drive: Drive) -> None:
        drive, row = self._limits.clipped(drive), self._drives[TEAM_NUMBER[place[0]], place[1] - 1]
        assert self._limits.allow(drive)
        row["at"], row["dribbles"] = self.now, drive.dribble
        row["vx_m_s"], row["vy_m_s"], row["turn_rad_s"] = drive.vx_m_s, drive.vy_m_s, drive.turn_rad_s
        if drive.kick_m_s:
            row["kicked_at"], row["kick_m_s"] = self.now, drive.kick_m_s

    @property
    def _limits(self) -> DriveLimits:
        drive = self.settings.synthetic.drive
        return DriveLimits(drive.speed_m_s, drive.sideways_m_s, drive.turn_rad_s, drive.kick_m_s, drive.dribbler)

    def robot(self, place: Place) -> Robot:
        """What a controller may know of a robot."""
        field = self.settings.field
        radius_m = nearest_m(self.settings, place[0])
        return Robot(*place, self._limits, radius_m, (field.length_m, field.width_m))


def _track(team: Team, worn: int, body: list[float], at: Instant) -> RobotTrack:
    x, y, heading, vx, vy, turn = body
    return RobotTrack(team, worn, x, y, heading, vx, vy, turn, 0.001, 0.01, 1.0, at)
