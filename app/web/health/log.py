"""The log's lines about the health of the service: one for each change of its state, and for each new cause."""

import asyncio

from app.web.blackboard import Blackboard
from app.web.health.monitor import Health, HealthMonitor, HealthState
from app.web.health.readiness import is_starting
from app.web.log_output import write_line
from vision_core.clock import Instant, seconds_between

EVERY_S = 0.5
NOT_READY_HOLD_S = 2.0
"""A process that was replaced is back before; while kernels compile, the supervisor prints the progress."""
IN_WORDS = {HealthState.READY: "ready", HealthState.DEGRADED: "ready but degraded", HealthState.NOT_READY: "not ready"}


class HealthLog:
    """Prints a line when the state changes or a new cause of worse service appears."""

    def __init__(self) -> None:
        self._state: HealthState | None = None
        self._causes: frozenset[str] = frozenset()
        """Keys of the degradations at the last call."""
        self._unready_since: Instant | None = None

    def note(self, health: Health, now: Instant, *, is_starting: bool) -> None:
        """Take the health of an instant. is_starting: processes still start, so that "not ready" is no news."""
        before, self._causes = self._causes, frozenset(cause.key for cause in health.degradations)
        if health.state is HealthState.NOT_READY:
            self._unready_since = None if is_starting else self._unready_since or now
            if self._unready_since is None or seconds_between(self._unready_since, now) < NOT_READY_HOLD_S:
                return
        else:
            self._unready_since = None
        if health.state is not self._state:
            self._state = health.state
            write_line(line_of(health))
        elif appeared := [cause.sentence for cause in health.degradations if cause.key not in before]:
            write_line(f"degraded: {'; '.join(appeared)}")


def line_of(health: Health) -> str:
    """The state and its causes in one line."""
    causes = "; ".join(cause.sentence for cause in health.reasons or health.degradations)
    return f"{IN_WORDS[health.state]}: {causes}" if causes else IN_WORDS[health.state]


async def watch_health(blackboard: Blackboard, monitor: HealthMonitor) -> None:
    """Judge the health for as long as the web process runs, so that causes are timed, and print its changes."""
    log = HealthLog()
    while True:
        snapshot = blackboard.read()
        log.note(monitor.judge(snapshot), snapshot.now, is_starting=is_starting(snapshot))
        await asyncio.sleep(EVERY_S)
