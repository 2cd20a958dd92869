"""Task: images -> obstacles. Less often than frames come; the tracker predicts them in between."""

from vision_core.models.camera_setup import CameraSetup
from vision_core.objects.obstacles import ObstacleFinder
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult
from vision_core.settings.schema import Settings
from vision_core.types.objects import Obstacles


def finder_from(settings: Settings, camera: CameraSetup) -> ObstacleFinder:
    """The obstacle finder of a venue's camera."""
    return ObstacleFinder(
        settings.field,
        settings.robots,
        settings.ball.radius_m,
        camera.model,
        camera.size_px,
        settings.obstacles,
        camera.masked,
    )


def start(handle: Handle) -> Step:
    """Make the finder."""
    camera = handle.camera.name
    finder = finder_from(handle.settings, handle.camera)
    images = Images(handle)
    sightings = handle.reader(records.sightings(camera))
    obstacles = handle.writer(records.obstacles(camera))

    def step(_release: Release) -> StepResult:
        now = handle.clock.now()
        seen = sightings.read(now)
        image = images.newest()
        if image is None:
            return images.none_result
        if seen is None or not seen.valid:  # without known robots, each robot would be taken for an obstacle
            return IDLE
        things = finder.find(image.pixels, seen.value.robots, seen.value.balls)
        obstacles.write(Obstacles(camera, image.number, image.grabbed, things), image.grabbed, handle.clock.now())
        return RAN

    return step
