"""Process: images -> why nothing or too little is seen. Looks at one image now and then, when it has the time."""

from vision_core.clock import NS_PER_S, MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.attachment import attach
from vision_core.tasks.diagnosis import reasons_of
from vision_core.tasks.gauge import Gauge
from vision_core.tasks.glimpses import glimpses
from vision_core.tasks.perception import Perception
from vision_core.types.objects import Diagnosis

PERIOD_NS = NS_PER_S


def main() -> None:
    """Run until the supervisor says stop."""
    attachment = attach()
    clock = MonotonicClock()
    gauge = Gauge(attachment, clock.now())
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    camera = settings.camera
    perception = Perception(settings)
    perception.warm_up()
    diagnosis = records.diagnosis(camera.name).writer(attachment.store)
    for image, taken in glimpses(attachment, gauge, clock, camera, PERIOD_NS):
        seen = perception.perceive(image, clock).record()
        told = Diagnosis(camera.name, image.number, image.grabbed, reasons_of(perception, seen))
        done = clock.now()
        diagnosis.write(told, image.grabbed, done)
        gauge.ran(taken, done)


if __name__ == "__main__":
    main()
