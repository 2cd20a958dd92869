"""The record ``live_settings``: what every process applies at a frame boundary."""

from collections.abc import Mapping
from dataclasses import replace

from vision_core.clock import Instant, MonotonicClock
from vision_core.rtdb import records
from vision_core.rtdb.infos import EndedSession, LiveSettings, TaskOverride
from vision_core.rtdb.store import Store
from vision_core.settings.live import LIVE_OF_TASKS
from vision_core.settings.schema import Settings, TaskSettings
from vision_core.types.objects import Team

ENDED_KEPT = 32
"""Sessions ended by the operator that are remembered; each is ended within a frame."""


class LivePublisher:
    """Writes the record; the web process is its only writer."""

    def __init__(self, store: Store) -> None:
        self._clock = MonotonicClock()
        self._writer = records.LIVE_SETTINGS.writer(store)
        stored = records.LIVE_SETTINGS.reader(store).read(self._clock.now())
        self._published = stored.value if stored else None
        self._ended: tuple[EndedSession, ...] = stored.value.ended if stored else ()
        self._fairness_asked = stored.value.fairness_asked if stored else Instant(0)
        self._games = stored.value.games if stored else 0

    def end_session(self, team: Team, number: int, since: Instant) -> None:
        """Remember a session that is to end; ``publish`` tells it."""
        self._ended = (*self._ended, EndedSession(team, number, since))[-ENDED_KEPT:]

    def begin_fairness(self) -> None:
        """A new record of fairness is to begin; ``publish`` tells it."""
        self._fairness_asked = self._clock.now()

    def begin_game(self) -> None:
        """Remember that a new game is to begin; ``publish`` tells it."""
        self._games += 1

    def publish(
        self, settings: Settings, started: Settings, revision: int, keys: Mapping[str, str], monitor_key: str | None
    ) -> None:
        """Write what can be applied at once.

        started: the settings with which the service was started; keys: the digest of the key of the team that plays
        each color; monitor_key: that of the monitors' key.
        """
        now = self._clock.now()
        overrides = _overrides(settings.tasks, started.tasks)
        live = replace(
            LiveSettings.of(settings, revision, overrides),
            ended=self._ended,
            keys=dict(keys),
            monitor_key=monitor_key,
            fairness_asked=self._fairness_asked,
            games=self._games,
        )
        if live != self._published:
            self._writer.write(live, now, now)
            self._published = live


def _overrides(tasks: Mapping[str, TaskSettings], started: Mapping[str, TaskSettings]) -> dict[str, TaskOverride]:
    """The tasks that are to run otherwise than the task table has them."""
    found = {}
    for name, line in tasks.items():
        before = started.get(name)
        changed = {
            key: getattr(line, key) for key in LIVE_OF_TASKS if before and getattr(line, key) != getattr(before, key)
        }
        if changed:
            found[name] = TaskOverride(**changed)
    return found
