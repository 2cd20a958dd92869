"""Process: a warm spare. It loads everything that any process of the service needs, and waits to become one of them.

Theory of operation. A process that has ended must be back within a few periods of the camera, but starting Python with
every library and kernel takes seconds. So the supervisor keeps a few processes that have loaded everything. Its message
comes as one line of JSON on standard input (``scheduling.attachment.Become``): the main module to run, and the
resources of that process. From then on the spare is no different from a process that was started for this purpose.

While a spare loads, it has the kernel's batch policy, so that it delays no other process. A module that cannot be
imported is reported; it fails again, with its traceback, when the spare becomes a process that needs it.
"""

import gc
import os
import select
import signal
import sys
from collections.abc import Callable, Iterator
from importlib import import_module

from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.scheduling.attachment import VARIABLE, Attachment, Become, attach
from vision_core.settings.schema import Settings

HEARTBEAT_EVERY_S = 0.1
STANDARD_INPUT = 0
CHUNK = 65536


def main() -> None:
    """Load, wait, become. Arguments: names of modules to import, beside those of the task table."""
    attachment = attach_in_background()
    settings = records.SERVICE.reader(attachment.store).value(MonotonicClock().now()).settings
    for name, load in _loads(settings, sys.argv[1:]):
        try:
            load()
        except Exception as error:  # noqa: BLE001 (an import may raise anything)
            print(f"{attachment.resources.process}: {name} cannot be loaded: {error!r}", file=sys.stderr, flush=True)
    gc.collect()
    gc.freeze()  # later collections skip everything that is loaded now
    wait_and_become(attachment)


def attach_in_background() -> Attachment:
    """Attach with the batch policy. SIGTERM ends a spare at once: it has nothing to save."""
    attachment = attach()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    return attachment


def wait_and_become(attachment: Attachment) -> None:
    """Send heartbeats until the supervisor's message comes, then run its module; returns when there is none."""
    become = _message(attachment)
    if become is None:
        return
    attachment.store.close()
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, STANDARD_INPUT)
    os.close(nothing)
    if not become.hurried:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    os.environ[VARIABLE] = become.resources.encode()
    sys.argv = [become.module]
    import_module(become.module).main()


def _message(attachment: Attachment) -> Become | None:
    """The supervisor's message; None when it has closed the pipe without one."""
    clock, received = MonotonicClock(), b""
    poller = select.poll()
    poller.register(STANDARD_INPUT, select.POLLIN)
    while not received.endswith(b"\n"):
        attachment.heartbeat(clock.now())
        if poller.poll(HEARTBEAT_EVERY_S * 1e3):
            chunk = os.read(STANDARD_INPUT, CHUNK)
            if not chunk:
                return None
            received += chunk
    return Become.decode(received)


def _loads(settings: Settings, modules: list[str]) -> Iterator[tuple[str, Callable[[], object]]]:
    """Everything to load: a name, and a function that loads it."""
    from vision_core.pipeline import warm_up
    from vision_core.tasks.table import task_table

    tasks = (task.module for task in task_table(settings) if task.module)  # the page's is among the arguments
    for name in dict.fromkeys([*modules, *tasks]):
        yield name, lambda name=name: import_module(name)  # type: ignore[misc]
    for step in (warm_up.perception, warm_up.views, warm_up.camera):
        yield step.__name__, lambda step=step: step(settings)  # type: ignore[misc]


if __name__ == "__main__":
    main()
