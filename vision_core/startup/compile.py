"""Process that runs once, before the tasks: compiles every kernel into the cache, telling how far it is.

Each step is compiled by a process of its own, all at the same time. Each line on standard output is the progress so
far; the supervisor passes it on. When the cache is already complete there is nothing to do, and nothing heavy is
imported.
"""

import os
import shutil
import subprocess
import sys
import time

import msgspec

from vision_core.clock import MonotonicClock
from vision_core.native.kernel_cache import kernel_folder
from vision_core.rtdb import records
from vision_core.scheduling.attachment import attach
from vision_core.settings.schema import Settings

VERSIONS_KEPT = 5
"""Folders of kernels of other versions of the code, the newest ones."""
STEPS = ("perception", "views", "camera")
"""What there is to compile: functions of ``warm_up``."""
LOOK_EVERY_S = 0.2


def main() -> None:
    """Compile, then end."""
    attachment = attach()
    clock = MonotonicClock()
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings
    folder = kernel_folder()
    complete = folder / f"complete-{settings.source.uri.partition(':')[0]}"
    if complete.exists():
        return
    running = {step: started(step, settings) for step in STEPS}
    told = ""
    while running and not attachment.stopping:
        attachment.heartbeat(clock.now())
        ended = [step for step, process in running.items() if process.poll() is not None]
        if failed := [step for step in ended if running[step].returncode]:
            break
        running = {step: process for step, process in running.items() if step not in ended}
        progress = f"{len(STEPS) - len(running)} of {len(STEPS)} parts are compiled; left: {', '.join(running)}"
        if running and progress != told:
            print(told := progress, flush=True)
        time.sleep(LOOK_EVERY_S if running else 0.0)
    else:
        failed = []
    for process in running.values():
        process.kill()
    if failed:
        sys.exit(f"compiling {failed[0]} failed")
    if not running:
        complete.touch()
        _forget_other_versions()


def started(step: str, settings: Settings) -> subprocess.Popen[bytes]:
    """A process that compiles a step, and ends with this one; its settings come through its standard input."""
    process = subprocess.Popen(
        [sys.executable, "-m", "vision_core.pipeline.warm_up", step, str(os.getpid())],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
    )
    assert process.stdin is not None
    process.stdin.write(msgspec.json.encode(settings))
    process.stdin.close()
    return process


def _forget_other_versions() -> None:
    versions = sorted(kernel_folder().parent.iterdir(), key=lambda path: path.stat().st_mtime, reverse=True)
    for old in versions[VERSIONS_KEPT:]:
        shutil.rmtree(old, ignore_errors=True)


if __name__ == "__main__":
    main()
