"""The health of the service over time: what /readyz, /metrics, the status, the page and the log report alike."""

import threading
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from app.web.blackboard import ServiceSnapshot
from app.web.health.degradation import Degradation
from app.web.health.hysteresis import Hysteresis
from app.web.health.processes import process_degradations
from app.web.health.rates import rate_degradations
from app.web.health.readiness import reasons_not_ready
from app.web.health.rights import right_degradations
from app.web.health.sightings import sighting_degradations


class HealthState(StrEnum):
    """Whether robots are served, and how well."""

    READY = "ready"
    DEGRADED = "degraded"
    NOT_READY = "not_ready"


@dataclass(frozen=True, slots=True)
class Health:
    """The state of the service with its causes."""

    reasons: tuple[str, ...]
    """Why no robot is served; empty when robots are served."""
    degradations: tuple[Degradation, ...]
    """What is worse than it should be."""

    @property
    def state(self) -> HealthState:
        """Not ready with any reason, else degraded with any degradation."""
        if self.reasons:
            return HealthState.NOT_READY
        return HealthState.DEGRADED if self.degradations else HealthState.READY

    @property
    def is_ready(self) -> bool:
        """Are robots served, well or badly?"""
        return not self.reasons

    @property
    def sentences(self) -> list[str]:
        """The degradations, a line each."""
        return [degradation.sentence for degradation in self.degradations]


class HealthMonitor:
    """Judges snapshots. Threads may share it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._hysteresis = Hysteresis()

    def judge(self, snapshot: ServiceSnapshot) -> Health:
        """The health at the instant of a snapshot. Call it at least twice a second: measured causes have to last."""
        reasons = reasons_not_ready(snapshot)
        if reasons:  # rates and sightings follow from them; a short gap leaves the causes that were reported before
            return Health(reasons, tuple(cause for cause in known_degradations(snapshot) if not cause.hold_s))
        with self._lock:
            return Health(reasons, self._hysteresis.filtered(present_degradations(snapshot), snapshot.now))


def known_degradations(snapshot: ServiceSnapshot) -> Iterator[Degradation]:
    """Causes that need no served robot to be known."""
    yield from right_degradations(snapshot)
    yield from process_degradations(snapshot)


def present_degradations(snapshot: ServiceSnapshot) -> Iterator[Degradation]:
    """All causes that are present in one snapshot, whether they last or not."""
    yield from sighting_degradations(snapshot)
    yield from rate_degradations(snapshot)
    yield from known_degradations(snapshot)
