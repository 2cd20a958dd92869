"""Process: images -> obstacles. Released by every new frame, looks at as many as ``obstacles.rate_hz`` says."""

import numpy as np

from vision_core.clock import NS_PER_S, Instant, MonotonicClock
from vision_core.objects.obstacles import ObstacleFinder
from vision_core.rtdb import records
from vision_core.rtdb.attachment import attach
from vision_core.settings import Settings
from vision_core.settings_models import camera_model_from
from vision_core.tasks.gauge import Gauge
from vision_core.types.objects import Obstacles

LONGEST_WAIT_S = 0.5


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
    frames = attachment.store.reader(f"frames/{camera.name}")
    sightings = records.sightings(camera.name).reader(attachment.store)
    obstacles = records.obstacles(camera.name).writer(attachment.store)
    period_ns = round(NS_PER_S / settings.obstacles.rate_hz)
    copy = np.empty((camera.height_px, camera.width_px, 3), dtype=np.uint8)
    due = Instant(0)
    while not attachment.stopping:
        released = attachment.wait(LONGEST_WAIT_S)
        now = clock.now()
        gauge.publish_if_due(now)
        glance = frames.glance() if released and now >= due else None
        seen = sightings.read(now)
        if glance is None or seen is None or not seen.valid:  # who does not know the robots takes them for obstacles
            continue
        np.copyto(copy.reshape(-1), np.frombuffer(glance.payload, dtype=np.uint8))
        if not frames.holds(glance):  # overwritten while it was copied
            continue
        due = Instant(max(due + period_ns, now))
        things = finder.find(copy, seen.value.robots, seen.value.balls)
        found = Obstacles(camera.name, glance.sequence, glance.measured, things)
        done = clock.now()
        obstacles.write(found, glance.measured, done)
        gauge.ran(now, done)


if __name__ == "__main__":
    main()
