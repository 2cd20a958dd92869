"""The health of the service over time: what /readyz, /metrics, the status, the page and the log report alike."""

import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from app.web.blackboard import ServiceSnapshot
from app.web.health.cause import Cause
from app.web.health.hysteresis import Hysteresis
from app.web.health.losses import LastMinute, Losses, loss_causes
from app.web.health.processes import process_degradations
from app.web.health.rates import rate_degradations
from app.web.health.readiness import reasons_not_ready
from app.web.health.rights import right_degradations
from app.web.health.sightings import sighting_degradations
from vision_core.clock import Instant


class HealthState(StrEnum):
    """Whether robots are served, and how well."""

    READY = "ready"
    DEGRADED = "degraded"
    NOT_READY = "not_ready"


@dataclass(frozen=True, slots=True)
class Seen:
    """When a cause was reported."""

    first: Instant
    """For the first time since the start of the page's process."""
    since: Instant
    """Without a break until now."""


@dataclass(frozen=True, slots=True)
class Health:
    """The state of the service with its causes."""

    reasons: tuple[Cause, ...]
    """Why no robot is served; empty when robots are served."""
    degradations: tuple[Cause, ...]
    """What is worse than it should be."""
    losses: Losses = field(default_factory=Losses)
    seen: Mapping[str, Seen] = field(default_factory=dict)
    """When each cause was reported, by its key."""

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
    def causes(self) -> tuple[Cause, ...]:
        """All of them, those that keep robots from being served first."""
        return (*self.reasons, *self.degradations)


class HealthMonitor:
    """Judges snapshots. Threads may share it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._hysteresis = Hysteresis()
        self._last_minute = LastMinute()
        self._first: dict[str, Instant] = {}
        self._since: dict[str, Instant] = {}

    def judge(self, snapshot: ServiceSnapshot) -> Health:
        """The health at the instant of a snapshot. Call it at least twice a second: measured causes have to last."""
        reasons = reasons_not_ready(snapshot)
        with self._lock:
            losses = self._last_minute.losses(snapshot)
            if reasons:  # rates and sightings follow from them; a short gap leaves the causes that were reported before
                causes = tuple(cause for cause in known_degradations(snapshot) if not cause.hold_s)
            else:
                causes = self._hysteresis.filtered(present_degradations(snapshot, losses), snapshot.now)
            return Health(reasons, causes, losses, self._seen((*reasons, *causes), snapshot.now))

    def _seen(self, causes: tuple[Cause, ...], now: Instant) -> dict[str, Seen]:
        """Note the causes that are reported at an instant."""
        self._since = {cause.key: self._since.get(cause.key, now) for cause in causes}
        return {key: Seen(self._first.setdefault(key, since), since) for key, since in self._since.items()}


def known_degradations(snapshot: ServiceSnapshot) -> Iterator[Cause]:
    """Causes that need no served robot to be known."""
    yield from right_degradations(snapshot)
    yield from process_degradations(snapshot)


def present_degradations(snapshot: ServiceSnapshot, losses: Losses) -> Iterator[Cause]:
    """All causes that are present in one snapshot, whether they last or not."""
    yield from sighting_degradations(snapshot)
    yield from rate_degradations(snapshot)
    yield from loss_causes(snapshot, losses)
    yield from known_degradations(snapshot)
