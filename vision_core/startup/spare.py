"""Process: a warm spare. It loads all that any process of the service needs, and waits to become one of them.

Theory of operation. A missing process is to be back within a few periods of the camera, and Python with every library
and kernel takes seconds. So the supervisor keeps a few processes that have it all; its order comes as one line of JSON
on standard input: which module to run, and what is handed to it. From then on the process is no different from one
that was started for its task.

While it loads it is a batch process: who keeps time goes first, and it is never starved. What cannot be loaded is said,
and is loaded, or complained about, when its turn comes.
"""

import gc
import json
import os
import select
import signal
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

from vision_core.clock import MonotonicClock
from vision_core.rtdb import records
from vision_core.scheduling.attachment import VARIABLE, Attachment, attach
from vision_core.settings.schema import Settings

HEARTBEAT_EVERY_S = 0.1
ORDERS = 0
"""Descriptor of standard input."""
CHUNK = 65536


def main() -> None:
    """Load, wait, become. The arguments are names of modules to import, beside those of the task table."""
    attachment = attach_quietly()
    settings = records.SERVICE.reader(attachment.store).value(MonotonicClock().now()).settings
    for name, load in _loads(settings, sys.argv[1:]):
        try:
            load()
        except Exception as error:  # noqa: BLE001 (whatever a module does when it is imported)
            print(f"{attachment.resources.process}: {name} cannot be loaded: {error!r}", file=sys.stderr, flush=True)
    gc.collect()
    gc.freeze()  # what is loaded is no garbage: the collection before real time need not look at it
    wait_and_become(attachment)


def attach_quietly() -> Attachment:
    """Attach as one who stands back. SIGTERM ends a spare at once: it holds nothing."""
    attachment = attach()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    return attachment


def wait_and_become(attachment: Attachment) -> None:
    """Beat until the order comes, then run what it names; returns when there is nothing to become."""
    if (order := _order(attachment)) is None:
        return
    attachment.store.close()
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, ORDERS)
    os.close(nothing)
    if os.sched_getscheduler(0) == os.SCHED_BATCH:  # otherwise the supervisor has us hurry
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    os.environ[VARIABLE] = order["handed"]
    sys.argv = [order["module"]]
    import_module(order["module"]).main()


def _order(attachment: Attachment) -> dict[str, Any] | None:
    """The supervisor's order, {"module": ..., "handed": ...}; None when it has closed the pipe without one."""
    clock, heard = MonotonicClock(), b""
    poller = select.poll()
    poller.register(ORDERS, select.POLLIN)
    while not heard.endswith(b"\n"):
        attachment.heartbeat(clock.now())
        if poller.poll(HEARTBEAT_EVERY_S * 1e3):
            said = os.read(ORDERS, CHUNK)
            if not said:
                return None
            heard += said
    order: dict[str, Any] = json.loads(heard)
    return order


def _loads(settings: Settings, modules: list[str]) -> Iterator[tuple[str, Callable[[], object]]]:
    """What there is to load, with a name for each."""
    from vision_core.pipeline import warm_up
    from vision_core.tasks.table import task_table

    for name in dict.fromkeys([*modules, *(task.module for task in task_table(settings))]):
        yield name, lambda name=name: import_module(name)  # type: ignore[misc]
    for step in (warm_up.perception, warm_up.views, warm_up.camera):
        yield step.__name__, lambda step=step: step(settings)  # type: ignore[misc]


if __name__ == "__main__":
    main()
