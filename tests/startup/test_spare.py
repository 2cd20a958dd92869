"""What a spare loads before it takes the place of a process."""

from vision_core.startup import spare
from vision_core.tasks.table import task_table
from vision_core.venues.loader import load_settings

KERNEL_STEPS = {"perception", "views", "camera"}


def test_every_module_that_a_process_may_need_is_loaded() -> None:
    settings = load_settings()
    loads = dict(spare._loads(settings, ["vision_core.startup.process", "app.web.process"]))
    modules = loads.keys() - KERNEL_STEPS
    assert {task.module for task in task_table(settings) if task.module} < modules
    for name in modules:
        loads[name]()
