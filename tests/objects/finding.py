"""Finding robots in drawn pictures, for the tests of this folder."""

import msgspec
import numpy as np

from tests.objects.drawing import PAINT_TABLE, SETTINGS, Picture, overhead_camera
from vision_core.models.camera_kernels import camera_map_from
from vision_core.objects.observation import Observation
from vision_core.objects.robots.finder import RobotFinder, find_robots, robot_finder
from vision_core.objects.robots.scene import Scene
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import Pattern
from vision_core.settings.schema import Settings, TeamRobotSettings
from vision_core.types.tables import MAX_ROBOTS, ROBOT, Table
from vision_core.venues.loader import config_folder

SHIPPED = sorted(path.stem for path in (config_folder() / "patterns").glob("*.toml"))


def settings_of(blue: str, yellow: str = "", **robots: float) -> Settings:
    """Settings where each team wears its pattern, with the shape that the pattern brings."""
    teams = {"blue": _team(blue), "yellow": _team(yellow or blue)}
    changed = msgspec.structs.replace(SETTINGS.robots, **teams, **robots)
    return msgspec.structs.replace(SETTINGS, robots=changed)


def _team(name: str) -> TeamRobotSettings:
    shape = load_pattern(name).robot
    return TeamRobotSettings(pattern=name, outline=shape.outline, radius_m=shape.radius_m, height_m=shape.height_m)


def finder_of(blue: str, yellow: str = "", **robots: float) -> RobotFinder:
    return robot_finder(settings_of(blue, yellow, **robots), PAINT_TABLE)


def empty_picture(pattern: Pattern, robots: float = 1.5, across_px: float = 40.0) -> Picture:
    """A picture so many robots wide and high; a robot is so many pixels across."""
    side = round(robots * across_px)
    return Picture(overhead_camera(2.0 * pattern.robot.radius_m / across_px, side, side), side, side)


def middle(drawn: Picture, height_m: float) -> tuple[float, float]:
    center = np.array([[drawn.width / 2.0, drawn.height / 2.0]])
    x, y = drawn.camera.field_from_pixel(center, height_m)[0].tolist()
    return x, y


def scene_of(drawn: Picture, noise: float = 2.0, seed: int = 1, read: Table | None = None) -> Scene:
    """A drawn picture to be explained. read: as of ``Scene``; None: no robot is."""
    pixels = drawn.as_bytes(noise, seed)
    blobs = drawn.blobs(noise, seed, PAINT_TABLE)
    seen = Observation(blobs, len(blobs), pixels, PAINT_TABLE.classes, camera_map_from(drawn.camera))

    def find(finder: RobotFinder) -> Table:
        out = np.zeros(MAX_ROBOTS, dtype=ROBOT)
        return out[: find_robots(seen, finder, 0, out)]

    return Scene(seen, PAINT_TABLE, find, np.zeros(0, dtype=ROBOT) if read is None else read)


def seen_in(drawn: Picture, finder: RobotFinder, seed: int = 1) -> Table:
    """ROBOT table, shape (n,)."""
    return scene_of(drawn, seed=seed).robots(finder)
