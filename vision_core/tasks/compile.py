"""Process that runs once, before the tasks: compiles every kernel into the cache, telling how far it is.

Each line on standard output is the progress so far; the supervisor passes it on. When the cache is already
complete there is nothing to do, and nothing heavy is imported.
"""

import shutil

from vision_core.clock import MonotonicClock
from vision_core.kernel_cache import kernel_folder
from vision_core.rtdb import records
from vision_core.rtdb.attachment import attach
from vision_core.tasks.gauge import Gauge

VERSIONS_KEPT = 5
"""Folders of kernels of other versions of the code, the newest ones."""


def main() -> None:
    """Compile, then end."""
    attachment = attach()
    clock = MonotonicClock()
    gauge = Gauge(attachment, clock.now())
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    folder = kernel_folder()
    complete = folder / f"complete-{settings.source.uri.partition(':')[0]}"
    if complete.exists():
        return
    from vision_core.tasks.warm_up import warm_up_steps

    steps = warm_up_steps(settings)
    for number, (name, step) in enumerate(steps, start=1):
        print(f"{number} of {len(steps)}: {name}", flush=True)
        gauge.publish(clock.now())
        step()
    complete.touch()
    versions = sorted(folder.parent.iterdir(), key=lambda path: path.stat().st_mtime, reverse=True)
    for old in versions[VERSIONS_KEPT:]:
        shutil.rmtree(old, ignore_errors=True)


if __name__ == "__main__":
    main()
