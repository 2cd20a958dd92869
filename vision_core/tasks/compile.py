"""Process that runs once, before the tasks: compiles every kernel into the cache, telling how far it is.

Each line on standard output is the progress so far; the supervisor passes it on.
"""

from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.attachment import attach
from vision_core.tasks.gauge import Gauge
from vision_core.tasks.warm_up import warm_up_steps


def main() -> None:
    """Compile, then end."""
    attachment = attach()
    clock = MonotonicClock()
    gauge = Gauge(attachment, clock.now())
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    steps = warm_up_steps(settings)
    for number, (name, step) in enumerate(steps, start=1):
        print(f"{number} of {len(steps)}: {name}", flush=True)
        step()
        gauge.publish(clock.now())


if __name__ == "__main__":
    main()
