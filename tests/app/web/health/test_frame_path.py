"""The frame's path follows from the task table."""

from dataclasses import replace

from app.web.health.frame_path import camera_task, frame_path, image_tasks
from tests.app.fake_snapshot import serving_snapshot
from vision_core.tasks.table import task_table
from vision_core.venues.loader import load_settings


def test_a_simulated_camera_is_played_by_a_source() -> None:
    snapshot = serving_snapshot()
    assert [task.name for task in frame_path(snapshot)] == ["capture", "perceive", "serve"]
    assert [task.name for task in image_tasks(snapshot)] == ["source", "capture"]


def test_a_device_needs_no_source() -> None:
    settings = load_settings(options={"source.uri": "camera:0"})
    snapshot = serving_snapshot()
    snapshot = replace(snapshot, service=replace(snapshot.service, settings=settings, tasks=task_table(settings)))
    assert [task.name for task in frame_path(snapshot)] == ["capture", "perceive", "serve"]
    assert image_tasks(snapshot) == (camera_task(snapshot),)
