"""The way from a frame to its datagrams in a running service: its records, its tasks, and what these tell."""

from vision_core.clock import MonotonicClock
from vision_core.net.control import Attached
from vision_core.rtdb import records
from vision_core.rtdb.infos import TIMINGS, TaskInfo
from vision_core.timing.histogram import Counts, decode, quantile_s

FRAMES, SIGHTINGS, VIEWS = WAY = ("frames/main", "sightings/main", "views")
"""Written by capture, by perceive, and by serve when the last datagram is sent."""
WORKERS = ("perceive", "serve")
"""Who leads from one of these records to the next."""
US_PER_S = 1e6


def histograms_of(attached: Attached, kind: str) -> dict[str, Counts]:
    """Histograms so far of the tasks on the way; kind: one of TIMINGS. Raises RuntimeError when there is none."""
    found = {}
    for task in WORKERS:
        reading = attached.store.reader(records.timing(task).name).read(MonotonicClock().now())
        if reading is None:
            raise RuntimeError(f"timing/{task}: nothing could be read; a histogram was expected")
        found[task] = decode(TIMINGS, reading.value)[kind]
    return found


def quantile_us(counts: Counts, share: float) -> float:
    """A histogram's quantile [us], 0 for an empty one."""
    return (quantile_s(counts, share) or 0.0) * US_PER_S


def policy_of(info: TaskInfo) -> str:
    """The policy of a task, and why it is not the one that was asked for."""
    refusals = "; ".join(map(str, info.refusals))
    return f"{info.policy} ({refusals})" if refusals else info.policy


def policies_of(attached: Attached, tasks: tuple[str, ...] = ("capture", *WORKERS)) -> str:
    """What tasks run under, and why it is not what was asked for."""
    now, said = MonotonicClock().now(), []
    for task in tasks:
        info = records.task(task).reader(attached.store).value(now)
        said.append(f"{task} {policy_of(info)}")
    return ", ".join(said)
