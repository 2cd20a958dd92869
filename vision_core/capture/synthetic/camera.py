"""The simulated ceiling camera as a source of images."""

from functools import cached_property

from vision_core.capture.synthetic.render import Renderer
from vision_core.capture.synthetic.truth import Truth, truth_of
from vision_core.capture.synthetic.world import Snapshot, World
from vision_core.clock import Clock, Instant
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.models.camera import PinholeCamera
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import Settings
from vision_core.timing.rate_keeper import Keeper, rate_keeper

MAX_LEAP_S = 1.0
"""The world advances by at most this time between two images: after a pause of the machine the match goes on."""


class SyntheticCamera:
    """Renders a simulated match at the camera's rate. Implements PlayedSource.

    The match starts with the first image and advances through skipped periods, too. Raises SourceError when the camera
    model is no pinhole, or the pattern has no marker for a robot's id.
    """

    repeats = False

    def __init__(self, settings: Settings, camera: CameraSetup, clock: Clock, *, paced: bool) -> None:
        if not isinstance(camera.model, PinholeCamera):
            raise SourceError(
                "source.uri = synthetic with camera.model",
                found=camera.settings.model,
                accepted="pinhole: a lens to render",
            )
        self.rate_hz = camera.rate_hz
        self.description = f"synthetic, seed {settings.synthetic.seed}"
        self._settings = settings
        self._camera = camera
        self.world = World(settings)
        self.keeper: Keeper = rate_keeper(self.rate_hz, clock, paced=paced)
        self._shown = -1
        self._last: tuple[Instant, Snapshot] | None = None

    @cached_property
    def _renderer(self) -> Renderer:
        return Renderer(self._settings, self._camera, self.world.robots_worn)

    @property
    def truth(self) -> Truth:
        """Where robots and ball are in the last image, for scoring. Raises SourceError before the first."""
        if self._last is None:
            raise SourceError("truth of the synthetic camera", found="no image yet", accepted="a call of grab before")
        instant, scene = self._last
        return truth_of(instant, scene, self.world.robots_worn, self._camera, self._settings)

    def prepare(self) -> None:
        """Render the background; compile the kernels or load them from their cache."""
        self._renderer.draw(self._camera.black_image(), self.world.snapshot())

    def grab(self, pixels: Bytes) -> Instant:
        """Render the next image, as ``ImageSource.grab``; the instant is the middle of its exposure.

        The image is rendered before its instant and delivered at it, so that lags do not contain the time of rendering.
        """
        renderer = self._renderer
        instant = self.keeper.choose()
        periods = max(self.keeper.number - self._shown, 0)
        self.world.advance(min(periods / self.rate_hz, MAX_LEAP_S))
        self._shown = self.keeper.number
        scene = self.world.snapshot()
        self._last = instant, scene
        renderer.draw(pixels, scene)
        return self.keeper.sleep()

    def close(self) -> None:
        """No file or device is open."""
