"""What stands around a robot by one picture of the ceiling camera, to compare with the robot's own camera."""

from pathlib import Path

from msgspec.structs import replace

from vision_core.calibration.mirror.from_views import Surroundings
from vision_core.clock import Instant, MonotonicClock
from vision_core.errors import SourceError
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import field_of_floor
from vision_core.native.opencv import read_picture
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import Settings
from vision_core.tasks.obstacles import finder_from
from vision_core.types.image import ImageFrame
from vision_core.types.objects import RobotSighting, Team
from vision_core.types.tables import WorldTable
from vision_core.types.tracks import ObstacleTrack, RobotTrack, World
from vision_core.views.renderer import ViewRenderer

AT = Instant(0)
TURNLESS_RAD = 0.0
"""Heading of another robot that shows none: of a round outline it does not matter."""


def surroundings_in(file: Path, settings: Settings, team: Team, number: int) -> Surroundings:
    """Where the floor ends around a robot by a picture of the ceiling camera. number: as clients use it.

    In the robot's own picture a line that is painted at the foot of a wall is one with it: the floor ends before both.
    Raises SourceError when the picture cannot be read, has another size, or does not show the robot with its heading.
    """
    perception = Perception(settings, CameraSetup.from_settings(settings))
    camera = perception.camera
    pixels = read_picture(file, camera.size_px)
    seen = perception.perceive_still(ImageFrame(camera.name, 1, AT, pixels), MonotonicClock()).record()
    obstacles = finder_from(settings, camera).find(pixels, seen.robots, seen.balls)
    ids = settings.match.ids_of(team)[: settings.match.numbers]
    own = [one for one in seen.robots if one.team is team and 1 <= number <= len(ids) and one.id == ids[number - 1]]
    if not own or own[0].heading_rad is None:
        shown = ", ".join(f"{one.team} {'?' if one.id is None else one.id}" for one in seen.robots)
        raise SourceError(
            f"robot {team}:{number} in {file}",
            found=f"robots by marker id: {shown or 'none'}",
            accepted="a picture that shows it with its heading",
        )
    tracks = tuple(_track(one) for one in seen.robots)
    circles = tuple(ObstacleTrack(one.x_m, one.y_m, 0.0, 0.0, one.radius_m, AT) for one in obstacles)
    floor = replace(settings, field=field_of_floor(settings.field))
    renderer, world = ViewRenderer(floor), WorldTable.of(World(1, AT, tracks, None, circles))
    renderer.render(world)
    view = renderer.view(world, team, number)
    assert view is not None
    return Surroundings.of(view)


def _track(seen: RobotSighting) -> RobotTrack:
    heading = TURNLESS_RAD if seen.heading_rad is None else seen.heading_rad
    place = seen.x_m, seen.y_m, heading
    return RobotTrack(seen.team, seen.id, *place, 0.0, 0.0, 0.0, seen.position_sd_m, 0.0, seen.confidence, AT)
