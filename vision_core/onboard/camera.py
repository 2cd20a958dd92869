"""A robot's on-board camera in the simulated match: pictures of snapshots, and the match at the camera's rate."""

import math
from collections.abc import Iterator

import numpy as np

from vision_core.capture.synthetic.noise import SensorNoise
from vision_core.capture.synthetic.render import exposure_samples
from vision_core.capture.synthetic.world import Snapshot, World
from vision_core.client.panorama import HEIGHT_PX, MARGIN_PX, WIDTH_PX
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, Floats, rotation
from vision_core.models.from_settings import mirror_of
from vision_core.models.mirror import Mirror
from vision_core.onboard.mirror_shape import MirrorShape
from vision_core.onboard.ray_tracer import DARK, Labels, Optics, label, trace
from vision_core.onboard.scene import Scene, SceneMaker
from vision_core.settings.schema import S_PER_MS, Settings
from vision_core.types.objects import Team

SIZE_PX = (WIDTH_PX, HEIGHT_PX)
"""The paper's picture: where its mirror fits in, a pixel of it is one of equation 1."""
MAX_SIDE_PX = 4096
RATE_HZ = 30.0
SAMPLE_TURN_RAD = math.atan(0.25)
"""The 4x4 rays of a pixel are turned so far that they lie in 16 different rows and columns: far lines, much thinner
than a pixel, are met by about as many rays in every pixel."""
RIM_HORIZONS = 1.25
"""The mirror's rim lies 2 px of the paper's picture inside of its border, at most so many radii of the horizon out."""


class OnboardCamera:
    """The camera of one robot of the simulated match.

    robot: team and number, from 1; size_px: width and height; mirror: None for the robot's own. Raises
    SettingsError when the robot does not play or the size is not accepted.
    """

    def __init__(
        self,
        settings: Settings,
        robot: tuple[Team, int],
        *,
        size_px: tuple[int, int] = SIZE_PX,
        mirror: Mirror | None = None,
    ) -> None:
        _check_size(size_px)
        self.settings = settings
        self.robot = robot
        self.size_px = size_px
        self.mirror = mirror_of(settings.mirror, *robot) if mirror is None else mirror
        self.shape = MirrorShape.from_mirror(self.mirror)
        self.worn = World(settings).robots_worn
        self.row = _row_of(settings, robot, self.worn)
        """The robot's row in snapshots."""
        fits = min(1.0, (HEIGHT_PX / 2.0 - MARGIN_PX) / self.mirror.horizon_px)
        self.scale = min(size_px[0] / WIDTH_PX, size_px[1] / HEIGHT_PX) * fits
        """Pixels of the picture per pixel of equation 1."""
        self.rim_px = min((HEIGHT_PX / 2.0 - MARGIN_PX / 2.0) / fits, RIM_HORIZONS * self.mirror.horizon_px)
        """Radius of the mirror's rim in the picture [px of equation 1]."""
        self._maker = SceneMaker(settings, self.worn, self.row, self.shape)
        self.nearest_floor_m = self._maker.nearest_floor_m
        """The own chassis hides the floor nearer than this, see ``SceneMaker``."""
        vignetting, shape = settings.synthetic.vignetting, self.shape
        self._optics = Optics(shape.f_px, shape.a_m, shape.b_m, self.scale, self.rim_px, vignetting)
        self._samples = exposure_samples(settings.synthetic.exposure_ms * S_PER_MS)
        self._samples[:, :2] = self._samples[:, :2] @ rotation(SAMPLE_TURN_RAD)
        self._noise = SensorNoise(settings.synthetic, size_px[0] * size_px[1] * 3)

    def scene(self, snapshot: Snapshot) -> Scene:
        """What stands around the robot in a snapshot."""
        return self._maker.scene(snapshot)

    def picture(self, scene: Scene) -> Bytes:
        """The picture of a scene with the sensor's noise: blue green red, shape (height, width, 3)."""
        picture = self.exact_picture(scene)
        self._noise.add(picture)
        return picture

    def exact_picture(self, scene: Scene) -> Bytes:
        """The picture of a scene without noise."""
        picture = np.empty((self.size_px[1], self.size_px[0], 3), dtype=np.uint8)
        trace(picture, self._optics, self._samples, scene, DARK)
        return picture

    def labels(self, scene: Scene) -> tuple[Labels, Floats]:
        """What each pixel's center shows of a scene and how far from the viewpoint [m], as of ``ray_tracer.label``."""
        labels = np.empty((self.size_px[1], self.size_px[0]), dtype=np.int32)
        ranges = np.empty(labels.shape)
        label(labels, ranges, self._optics, scene)
        return labels, ranges

    def pixel_from_px(self, forward_px: Floats, left_px: Floats) -> Floats:
        """Columns and rows in the picture of places given in pixels of equation 1, shape (n, 2)."""
        width, height = self.size_px
        across = 0.5 * (width - 1) - self.scale * np.asarray(left_px)
        return np.stack([across, 0.5 * (height - 1) - self.scale * np.asarray(forward_px)], axis=-1)

    def video(self, world: World) -> Iterator[tuple[Snapshot, Bytes]]:
        """Snapshots and pictures of a match at RATE_HZ, from its present instant on, without end."""
        while True:
            snapshot = world.snapshot()
            yield snapshot, self.picture(self.scene(snapshot))
            world.advance(1.0 / RATE_HZ)


def _row_of(settings: Settings, robot: tuple[Team, int], worn: tuple[tuple[Team, int], ...]) -> int:
    """The row of a robot in snapshots."""
    team, number = robot
    ids = settings.match.ids_of(team)
    if not 1 <= number <= len(ids) or (team, ids[number - 1]) not in worn:
        playing = [f"{name}:{1 + place}" for name in Team for place in range(sum(other is name for other, _ in worn))]
        raise SettingsError(
            "the robot with the on-board camera", found=f"{team}:{number}", accepted=", ".join(playing) or "none plays"
        )
    return worn.index((team, ids[number - 1]))


def _check_size(size_px: tuple[int, int]) -> None:
    if not all(HEIGHT_PX // 4 <= side <= MAX_SIDE_PX for side in size_px):
        raise SettingsError(
            "the size of the on-board picture",
            found=f"{size_px[0]}x{size_px[1]}",
            accepted=f"sides of {HEIGHT_PX // 4}..{MAX_SIDE_PX} px",
        )
