"""The tasks that every frame passes, found in the task table by what they read and write."""

from collections.abc import Iterator

from app.web.blackboard import ServiceSnapshot
from vision_core.rtdb.task import Task


def frame_path(snapshot: ServiceSnapshot) -> tuple[Task, ...]:
    """The tasks in the frame's order: the one that publishes frames, then each that is triggered by the one before."""
    return tuple(_from_frames(snapshot))


def camera_task(snapshot: ServiceSnapshot) -> Task:
    """The task that publishes the camera's frames."""
    return frame_path(snapshot)[0]


def image_tasks(snapshot: ServiceSnapshot) -> tuple[Task, ...]:
    """The tasks that an image needs before it is published: a played source first, then the camera's task."""
    camera = camera_task(snapshot)
    after = frame_path(snapshot)[1:]
    source = (task for task in snapshot.service.tasks if task.on_frame_path and task not in (camera, *after))
    return (*source, camera)


def _from_frames(snapshot: ServiceSnapshot) -> Iterator[Task]:
    record = f"frames/{snapshot.camera.name}"
    task = next(task for task in snapshot.service.tasks if record in task.writes)
    yield task
    trigger: tuple[str, ...] = (record,)
    while following := [t for t in snapshot.service.tasks if t.on_frame_path and t.trigger in trigger]:
        yield following[0]
        trigger = following[0].writes
