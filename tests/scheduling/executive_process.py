"""Main module: an executive over tasks that only count, and somebody beside it who writes, proposes and stops.

Prints as JSON what was counted, and what the tasks' records say in the end.
"""

import json
import os
import threading
import time
from typing import Any

from msgspec import to_builtins

from tests.scheduling.tables import line
from vision_core.clock import MonotonicClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.rtdb.infos import LiveSettings, TaskOverride
from vision_core.rtdb.items import packed
from vision_core.rtdb.store import create_block
from vision_core.rtdb.task import PERIOD, Task
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.executive import Executive
from vision_core.scheduling.handle import Handle
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult
from vision_core.venues.loader import load_settings

IMAGES, SEEN = packed("images", int, 64, 1.0), packed("seen", int, 64, 1.0)
TASKS = (
    line("slow", PERIOD, (), (), "p", priority=3, period_s=0.04),
    line("eyes", "images", ("images",), ("seen",), "p", priority=5, budget_s=1e-9),
    line("ears", "seen", ("seen",), (), "p", priority=1),
    line("idle", PERIOD, (), (), "p", priority=4, period_s=0.02),
)
PHASE_S = 0.5


def main() -> None:
    """Phases of half a second: as declared; slow twice as fast and eyes off; all as declared again."""
    specs = (
        *(item.spec for item in (IMAGES, SEEN, records.LIVE_SETTINGS)),
        *(records.task(task.name).spec for task in TASKS),
        *(records.timing(task.name) for task in TASKS),
        records.heartbeat("p"),
    )
    block, wake, heard = create_block(specs), os.eventfd(0, os.EFD_NONBLOCK), os.eventfd(0, os.EFD_NONBLOCK)
    resources = ChildResources("p", os.getpid(), time.monotonic_ns(), block, specs, wake, {"seen": (heard,)}, {})
    attachment = Attachment(resources)
    counts: dict[str, list[int]] = {task.name: [0] for task in TASKS}
    order: list[str] = []

    def counting(task: Task) -> tuple[Handle, Any]:
        handle = Handle(task, attachment, load_settings(), CameraSetup.from_settings(load_settings()))
        told = handle.writer(SEEN) if task.name == "eyes" else None

        def step(_release: Release) -> StepResult:
            counts[task.name][-1] += 1
            order.append(task.name)
            if told is not None:
                told.write(1, handle.clock.now(), handle.clock.now())
            return IDLE if task.name == "idle" else RAN

        return handle, step

    def drive() -> None:
        clock, images = MonotonicClock(), IMAGES.writer(attachment.store)
        proposals = records.LIVE_SETTINGS.writer(attachment.store)
        changes = {"slow": TaskOverride(period_ms=20.0), "eyes": TaskOverride(enabled=False)}
        for tasks in ({}, changes, {}):
            proposals.write(LiveSettings.of(load_settings(), tasks=tasks), clock.now(), clock.now())
            for _ in range(10):
                images.write(1, clock.now(), clock.now())
                os.eventfd_write(wake, 1)
                time.sleep(PHASE_S / 10)
            for count in counts.values():
                count.append(0)
        attachment.stopping = True

    executive = Executive(attachment, [counting(task) for task in TASKS])
    threading.Thread(target=drive).start()
    executive.run()
    now = MonotonicClock().now()
    told = {task.name: to_builtins(records.task(task.name).reader(attachment.store).value(now)) for task in TASKS}
    print(json.dumps({"counts": counts, "order": order, "heard": os.eventfd_read(heard), "told": told}))


if __name__ == "__main__":
    main()
