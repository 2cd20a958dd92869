"""Process that runs once, before the tasks: compiles kernels of the service, and prints how far it is.

It runs twice: for the frame path, then for all other tasks, while robots are served already.

Worker processes, one for each core, compile step after step; the step that the others wait for longest comes first.
Each line on standard output is the progress so far; the supervisor passes it on. When everything was compiled before,
there is nothing to do, and nothing heavy is imported.
"""

import contextlib
import os
import select
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import msgspec

from vision_core.clock import MonotonicClock
from vision_core.errors import ServiceError
from vision_core.native.kernel_folder import (
    DAMAGED,
    choose_kernel_folder,
    compiled_kernels,
    delete_damaged,
    delete_old_versions,
    is_complete,
    kernel_files,
    mark_complete,
)
from vision_core.native.private_folder import PrivateFolder
from vision_core.rtdb import records
from vision_core.scheduling.attachment import attach
from vision_core.settings.schema import Settings
from vision_core.tasks.table import COMPILER_OF_OTHERS


@dataclass(frozen=True, slots=True)
class Step:
    """A part of what there is to compile; ``pipeline.warm_up`` has a function for each."""

    name: str
    after: tuple[str, ...] = ()
    """Steps whose kernels it calls."""
    on_frame_path: bool = True
    """No robot is served without its kernels. The others are compiled while robots are served."""


STEPS = (
    Step("robots"),
    Step("blobs"),
    Step("arguments"),
    Step("balls"),
    Step("camera"),
    Step("verification", after=("robots",)),
    Step("confirmation", after=("robots", "arguments")),
    Step("perception", after=("robots", "verification", "blobs", "balls", "arguments")),
    Step("views"),
    Step("tracks"),
    Step("diagnosis", after=("perception", "confirmation"), on_frame_path=False),
)
"""In the order in which they are begun: steps that others wait for, then the longest."""
FRAME_PATH = tuple(step for step in STEPS if step.on_frame_path)
OTHERS = tuple(step for step in STEPS if not step.on_frame_path)
WORKER = ("-m", "vision_core.pipeline.warm_up")
NICENESS = 5
"""Of what compiles while robots are served: they come first, but a busy machine must not keep it from ending."""
LOOK_EVERY_S = 0.2
NAMED_IN_SUMMARY = 3


def main() -> None:
    """Compile the kernels of the frame path or, under the name COMPILER_OF_OTHERS, all others; then end."""
    attachment = attach()
    steps = FRAME_PATH
    if attachment.resources.process == COMPILER_OF_OTHERS:
        steps = OTHERS
        os.nice(NICENESS)
    clock = MonotonicClock()
    settings = records.SERVICE.reader(attachment.store).value(clock.now()).settings

    def go_on() -> bool:
        attachment.heartbeat(clock.now())
        return not attachment.stopping

    try:
        compile_kernels(settings, steps, show=lambda line: print(line, flush=True), log=_log, go_on=go_on)
    except ServiceError as error:
        sys.exit(str(error))


def compile_kernels(
    settings: Settings,
    steps: Sequence[Step] = STEPS,
    *,
    show: Callable[[str], None],
    log: Callable[[str], None],
    go_on: Callable[[], bool],
) -> None:
    """Compile every kernel that a start with these settings needs and that is not on disk yet.

    steps: a part of STEPS; after the last of STEPS all counts as compiled. show: gets the progress whenever it changes;
    log: gets each line for the log; go_on: is asked several times a second, and False ends the work.
    Raises ServiceError when a step fails, or when there is no folder to write to.
    """
    began = time.monotonic()
    folder, notice = choose_kernel_folder()
    if folder is None:
        raise ServiceError(
            "a folder for compiled kernels", found=notice, accepted="PSLV_DATA_DIR names one that is ours"
        )
    if notice:
        log(notice)
    if is_complete(folder, settings.source.kind):
        show(f"{len(steps)} of {len(steps)} parts were compiled before")
        return
    if delete_damaged(folder):
        log(DAMAGED.format(folder.path))
    before = set(kernel_files(folder))
    shown = ""
    for progress in _progress(settings, steps):
        if progress != shown:
            show(shown := progress)
        if not go_on():
            return
    log(_summary(folder, before, time.monotonic() - began))
    if STEPS[-1] not in steps:
        return
    newest, _ = choose_kernel_folder()
    if newest is not None and newest.path == folder.path:  # else the code changed meanwhile
        with contextlib.suppress(OSError):  # a full disk: the next start compiles what is missing
            mark_complete(folder, settings.source.kind)
        delete_old_versions(folder)


def _progress(settings: Settings, steps: Sequence[Step]) -> Iterator[str]:
    """Compile steps; yields how far it is, several times a second. Raises ServiceError when a step fails."""
    left, done = list(steps), set[str]()
    ours = {step.name for step in steps}
    workers = [_Worker(settings) for _ in range(min(len(os.sched_getaffinity(0)), len(steps)))]
    try:
        while len(done) < len(steps):
            for worker in workers:
                ready = next((step for step in left if done.issuperset(ours.intersection(step.after))), None)
                if ready is not None and not worker.step:
                    left.remove(ready)
                    worker.begin(ready.name)
            busy = [worker for worker in workers if worker.step]
            yield f"{len(done)} of {len(steps)} parts are compiled; now: {', '.join(worker.step for worker in busy)}"
            for worker in select.select(busy, [], [], LOOK_EVERY_S)[0]:
                done.add(worker.finish())
        yield f"{len(steps)} of {len(steps)} parts are compiled"
    finally:
        for worker in workers:
            worker.end()


class _Worker:
    """A process that compiles one step after another, and ends with this one."""

    def __init__(self, settings: Settings) -> None:
        self.step = ""
        """What it compiles now; empty: nothing."""
        self._process = subprocess.Popen(
            [sys.executable, *WORKER, str(os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
        )
        self._write(msgspec.json.encode(settings))

    def fileno(self) -> int:
        """Readable when the step is done, or the process has ended."""
        assert self._process.stdout is not None
        return self._process.stdout.fileno()

    def begin(self, step: str) -> None:
        """Compile a step."""
        self.step = step
        self._write(step.encode())

    def finish(self) -> str:
        """The step that is done. Raises ServiceError when the process ended instead."""
        assert self._process.stdout is not None
        step, self.step = self.step, ""
        if self._process.stdout.readline().decode().strip() != step:
            self._process.kill()
            status = self._process.wait()
            raise ServiceError(f"compiling {step}", found=f"exit status {status}", accepted="see the lines before")
        return step

    def end(self) -> None:
        """End the process, whatever it does."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            pipe.close()

    def _write(self, line: bytes) -> None:
        """Send a line; that nobody reads it any more is seen when the step is to be finished."""
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.write(line + b"\n")


def _summary(folder: PrivateFolder, before: set[str], seconds: float) -> str:
    """What was compiled, in one line."""
    fresh = compiled_kernels(folder, [name for name in kernel_files(folder) if name not in before])
    longest = sorted(fresh, key=lambda kernel: -kernel.seconds)[:NAMED_IN_SUMMARY]
    named = ", ".join(f"{kernel.kernel.rpartition('.')[2]} {kernel.seconds:.1f} s" for kernel in longest)
    work_s = sum(kernel.seconds for kernel in fresh)
    return f"compiled {len(fresh)} kernels in {seconds:.0f} s ({work_s:.0f} s of processor time); the longest: {named}"


def _log(line: str) -> None:
    """A line for the log. That its disk is full, or nobody reads it, is no reason to stop."""
    with contextlib.suppress(OSError):
        print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
