"""A task on a real-time database, without a supervisor."""

import os
from typing import Any

from vision_core.clock import MonotonicClock
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb.store import create_block
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import Release, StepResult
from vision_core.settings.schema import Settings
from vision_core.tasks.table import record_specs, task_table


class Stage:
    """The task of a module, and what gives it images."""

    def __init__(self, module: Any, settings: Settings) -> None:
        name = module.__name__.rsplit(".", 1)[-1]
        tasks = {task.name: task for task in task_table(settings)}
        specs = record_specs(settings, tuple(tasks.values()), tuple(tasks))
        self.block = create_block(specs)
        self.clock = MonotonicClock()
        attachment = Attachment(ChildResources("diagnose", os.getpid(), 0, self.block, specs, None, {}, {}))
        self.store = attachment.store
        self.handle = Handle(tasks[name], attachment, settings, CameraSetup.from_settings(settings))
        self.step: Step = module.start(self.handle)
        self._frames = self.store.writer("frames/main")

    def show(self, pixels: Bytes) -> StepResult:
        """A step with a picture that is grabbed now, shape (height, width, 3)."""
        now = self.clock.now()
        self._frames.write(pixels.tobytes(), now, now)
        return self.step(Release(now, now))

    def close(self) -> None:
        os.close(self.block)
