"""Task: images -> obstacles. Less often than frames come; the tracker predicts them in between."""

from vision_core.models.from_settings import camera_model_from
from vision_core.objects.obstacles import ObstacleFinder
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import Release
from vision_core.settings.schema import Settings
from vision_core.types.objects import Obstacles


def finder_from(settings: Settings) -> ObstacleFinder:
    """The obstacle finder of a venue."""
    camera = settings.camera
    return ObstacleFinder(
        settings.field,
        settings.robots,
        settings.ball.radius_m,
        camera_model_from(settings),
        (camera.width_px, camera.height_px),
        settings.obstacles,
    )


def start(handle: Handle) -> Step:
    """Make the finder."""
    camera = handle.settings.camera.name
    finder = finder_from(handle.settings)
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
