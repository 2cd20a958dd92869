"""Process: images -> obstacles. Released by every new frame, looks at as many as ``obstacles.rate_hz`` says."""

from vision_core.clock import NS_PER_S, MonotonicClock
from vision_core.objects.obstacles import ObstacleFinder
from vision_core.rtdb import records
from vision_core.rtdb.attachment import attach
from vision_core.settings import Settings
from vision_core.settings_models import camera_model_from
from vision_core.tasks.gauge import Gauge
from vision_core.tasks.glimpses import glimpses
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


def main() -> None:
    """Run until the supervisor says stop."""
    attachment = attach()
    clock = MonotonicClock()
    gauge = Gauge(attachment, clock.now())
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    camera = settings.camera
    finder = finder_from(settings)
    sightings = records.sightings(camera.name).reader(attachment.store)
    obstacles = records.obstacles(camera.name).writer(attachment.store)
    period_ns = round(NS_PER_S / settings.obstacles.rate_hz)
    for image, taken in glimpses(attachment, gauge, clock, camera, period_ns):
        seen = sightings.read(taken)
        if seen is None or not seen.valid:  # who does not know the robots takes them for obstacles
            continue
        things = finder.find(image.pixels, seen.value.robots, seen.value.balls)
        done = clock.now()
        obstacles.write(Obstacles(camera.name, image.number, image.grabbed, things), image.grabbed, done)
        gauge.ran(taken, done)


if __name__ == "__main__":
    main()
