"""Task: images -> obstacles. Less often than frames come; the tracker predicts them in between."""

from vision_core.models.camera_setup import CameraSetup
from vision_core.objects.obstacles import ObstacleFinder
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import Release
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
    )


def start(handle: Handle) -> Step:
    """Make the finder."""
    camera = handle.camera.name
    finder = finder_from(handle.settings, handle.camera)
    images = Images(handle)
    sightings = handle.reader(records.sightings(camera))
    obstacles = handle.writer(records.obstacles(camera))

    def step(release: Release) -> bool:
        now = handle.clock.now()
        seen = sightings.read(now)
        image = images.newest(release)
        if image is None or seen is None or not seen.valid:  # who does not know the robots takes them for obstacles
            return False
        things = finder.find(image.pixels, seen.value.robots, seen.value.balls)
        obstacles.write(Obstacles(camera, image.number, image.grabbed, things), image.grabbed, handle.clock.now())
        return True

    return step
