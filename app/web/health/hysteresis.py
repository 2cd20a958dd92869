"""A measured cause is reported when it has lasted for a while, and withdrawn when it has been absent for a while."""

from collections.abc import Iterable
from dataclasses import dataclass

from app.web.health.cause import Cause
from vision_core.clock import Instant, seconds_between

RELEASE_S = 3.0
"""A cause that was reported stays reported until it has been absent for this long. A value that crosses its limit
several times a second, or a process that crashes again and again, then gives one steady message."""


@dataclass(frozen=True, slots=True)
class _Episode:
    """A cause from the snapshot in which it appeared until it is released."""

    since: Instant
    last: Instant
    """The newest snapshot in which it was present."""
    newest: Cause


class Hysteresis:
    """Remembers since when each cause has been present."""

    def __init__(self) -> None:
        self._episodes: dict[str, _Episode] = {}

    def filtered(self, present: Iterable[Cause], now: Instant) -> tuple[Cause, ...]:
        """The causes to report: those of the snapshot taken at ``now`` in their order, then those not yet released."""
        before = {key: episode for key, episode in self._episodes.items() if _is_current(episode, now)}
        self._episodes = {}
        for degradation in present:
            episode = before.pop(degradation.key, None)
            self._episodes[degradation.key] = _Episode(episode.since if episode else now, now, degradation)
        self._episodes |= before
        return tuple(episode.newest for episode in self._episodes.values() if _has_lasted(episode))


def _is_current(episode: _Episode, now: Instant) -> bool:
    return episode.newest.hold_s > 0.0 and seconds_between(episode.last, now) <= RELEASE_S


def _has_lasted(episode: _Episode) -> bool:
    return seconds_between(episode.since, episode.last) >= episode.newest.hold_s
