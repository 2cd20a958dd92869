"""The frame path of a running service: the records and tasks between a frame and its datagrams."""

from vision_core.clock import US_PER_S, MonotonicClock
from vision_core.net.control import Attached
from vision_core.rtdb import records
from vision_core.rtdb.infos import TIMINGS, TaskInfo
from vision_core.rtdb.task import Task
from vision_core.timing.histogram import Counts, decode, quantile_s

FRAMES, SIGHTINGS, VIEWS = FRAME_PATH = ("frames/main", "sightings/main", "views")
"""Written by capture, by perceive, and by serve when the last datagram is sent; main is the default venue's camera."""


def tasks_of(attached: Attached) -> tuple[Task, ...]:
    """The task table of a running service."""
    return records.SERVICE.reader(attached.store).value(MonotonicClock().now()).tasks


def workers_of(attached: Attached) -> tuple[str, ...]:
    """The tasks that read one record of FRAME_PATH and write the next: perceive and serve."""
    by_trigger = {task.trigger: task.name for task in tasks_of(attached) if task.on_frame_path}
    return tuple(by_trigger[record] for record in FRAME_PATH[:-1])


def histograms_of(attached: Attached, kind: str) -> dict[str, Counts]:
    """Duration histograms of ``workers_of`` since the start of the service, by task. kind: one of TIMINGS.

    Raises RuntimeError when a task has not written its histograms.
    """
    histograms = {}
    for task in workers_of(attached):
        reading = attached.store.reader(records.timing(task).name).read(MonotonicClock().now())
        if reading is None:
            raise RuntimeError(f"timing/{task}: no value was found; a histogram was expected")
        histograms[task] = decode(TIMINGS, reading.value)[kind]
    return histograms


def quantile_us(counts: Counts, share: float) -> float:
    """Quantile of a histogram [us]; 0 when it is empty. share: 0..1, 0.5 for the median."""
    return (quantile_s(counts, share) or 0.0) * US_PER_S


def policy_of(info: TaskInfo) -> str:
    """The scheduling policy of a task, with the reasons where it is not the requested one."""
    refusals = "; ".join(map(str, info.refusals))
    return f"{info.policy} ({refusals})" if refusals else info.policy


def policies_of(attached: Attached) -> str:
    """The scheduling policies of all tasks on the frame path."""
    now, policies = MonotonicClock().now(), []
    for task in tasks_of(attached):
        if task.on_frame_path:
            info = records.task(task.name).reader(attached.store).value(now)
            policies.append(f"{task.name} {policy_of(info)}")
    return ", ".join(policies)
