"""A task of your own: the distance from the ball to the nearest robot, as a record, five times a second.

In a venue file:

    [tasks.nearest]
    module = "examples.own_task"
    period_ms = 200.0
    offset_ms = 7.0
    priority = 10
    budget_ms = 2.0
    reads = ["world"]
    writes = ["lab/nearest"]

``pslv tasks --venue FILE`` shows it in the table, ``pslv top`` its record. Run from the repository's root, or install
your module.
"""

import math

from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult


def start(handle: Handle) -> Step:
    """Called once, when the process starts: prepare what takes time here."""
    world = handle.reader(records.WORLD)
    nearest = handle.raw_writer("lab/nearest")

    def step(_release: Release) -> StepResult:
        """Called at every release; IDLE: there was nothing to do."""
        now = handle.clock.now()
        seen = world.read(now)
        if seen is None or not seen.valid or seen.value.ball is None or not seen.value.robots:
            return IDLE
        ball = seen.value.ball
        distance_m = min(math.hypot(robot.x_m - ball.x_m, robot.y_m - ball.y_m) for robot in seen.value.robots)
        nearest.write(f"{distance_m:.3f} m".encode(), seen.measured, now)
        return RAN

    return step
