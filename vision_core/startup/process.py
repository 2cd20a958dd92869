"""Process: the tasks of the table that name it. Prepares each, then runs them at their times until told to stop."""

from importlib import import_module

from vision_core.clock import MonotonicClock
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb import records
from vision_core.scheduling.attachment import attach
from vision_core.scheduling.executive import Executive
from vision_core.scheduling.handle import Handle
from vision_core.tasks.table import task_table


def main() -> None:
    """Run until the supervisor says stop."""
    attachment = attach()
    settings = records.SERVICE.reader(attachment.store).value(MonotonicClock().now()).settings
    ours = [task for task in task_table(settings) if task.process == attachment.resources.process]
    camera = CameraSetup.from_settings(settings)
    handles = [Handle(task, attachment, settings, camera) for task in ours]
    Executive(attachment, [(handle, import_module(handle.task.module).start(handle)) for handle in handles]).run()


if __name__ == "__main__":
    main()
