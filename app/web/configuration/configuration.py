"""The one door through which the page changes anything.

A change is judged before it is kept: the settings that would follow are built from the user's files and the changed
overlay, by the loader of the files and its rules. So whatever is kept can be started with. Each process applies what
can be applied at a frame boundary when it reads the record ``live_settings``; ``waiting_for_restart`` names the rest.
"""

import threading
import time
from collections.abc import Callable, Mapping
from http import HTTPStatus
from typing import Any

from msgspec import to_builtins

from app.web.auth.team_keys import MONITORS
from app.web.configuration.keys import ADMISSION, plays, setting
from app.web.configuration.live_record import LivePublisher
from app.web.configuration.overlay import has_ended, overlay_from
from app.web.problems import RequestRefused
from app.web.storage.document import (
    Change,
    ConflictError,
    Document,
    EntryChange,
    Kind,
    NothingToUndoError,
)
from vision_core.clock import Instant
from vision_core.errors import SettingsError
from vision_core.rtdb.infos import ServiceInfo
from vision_core.rtdb.store import Store
from vision_core.settings.live import is_live
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team
from vision_core.venues.loader import settings_from_layers, with_overlay

SERVICE = "the service"
"""Who makes the changes that nobody asked for."""


class Configuration:
    """The settings in effect, with everything that was changed on the page. Threads may share it."""

    def __init__(
        self,
        store: Store,
        service: ServiceInfo,
        document: Document,
        clock: Callable[[], float] = time.time,
        key_digest: Callable[[str], str | None] = lambda _: None,
    ):
        """clock: gives the time of day [seconds since 1970]; key_digest: what is kept of a team's key, by its slug."""
        self.document = document
        self._key_digest = key_digest
        self._service = service
        self._clock = clock
        self._lock = threading.RLock()
        self._publisher = LivePublisher(store)
        self.base = settings_from_layers(with_overlay(service.layers, {}))
        """The settings of the user's files alone."""
        self._entries = document.entries()
        self.refused_overlay = ""
        """Why the changes that were kept do not fit to the files; empty when they do."""
        try:
            self.settings = self._settings_of(self._entries)
        except SettingsError as error:
            self.settings, self.refused_overlay = service.settings, str(error)
        self.publish()

    @property
    def entries(self) -> Mapping[str, Any]:
        """The document's entries; not to be changed."""
        return self._entries

    @property
    def revision(self) -> int:
        """Number of the newest change."""
        return self.document.revision

    def change(self, values: Mapping[str, Any], *, who: str, what: str, seen: int | None = None) -> Change | None:
        """Set entries, or delete those whose value is None. Returns None when nothing differs from before.

        seen: the revision that the person has seen. Raises RequestRefused when somebody else changed one of the entries
        since, and when the service could not run that way.
        """
        with self._lock:
            values = self._by_table(values)
            settings = self._judged(self._with(values), what)
            try:
                change = self.document.change(values, who=who, what=what, seen=seen)
            except ConflictError as conflict:
                raise _conflict(what, conflict) from None
            self._take_over(settings)
            return change

    def undo(self, *, who: str, seen: int) -> Change:
        """Take back the newest change. Raises RequestRefused."""
        return self._step(self.document.undoable(), self.document.undo, "undo", who, seen)

    def redo(self, *, who: str, seen: int) -> Change:
        """Make the change again that was taken back last. Raises RequestRefused."""
        return self._step(self.document.redoable(), self.document.redo, "redo", who, seen)

    def preview(self, values: Mapping[str, Any], what: str) -> list[EntryChange]:
        """What a change would change. Raises RequestRefused when the service could not run that way."""
        with self._lock:
            values = self._by_table(values)
            self._judged(self._with(values), what)
            return [EntryChange(key, self._entries.get(key), value) for key, value in sorted(values.items())]

    def with_changes(self, values: Mapping[str, Any], what: str) -> Settings:
        """The settings as they would be after a change. Raises RequestRefused when the service could not run so."""
        with self._lock:
            return self._judged(self._with(values), what)

    def end_session(self, team: Team, number: int, since: Instant) -> None:
        """End one session of a client; another init of the same client is accepted again."""
        with self._lock:
            self._publisher.end_session(team, number, since)
            self.publish()

    def begin_fairness(self) -> None:
        """Begin a new record of fairness."""
        with self._lock:
            self._publisher.begin_fairness()
            self.publish()

    def begin_game(self) -> None:
        """Begin a new game of the simulated match."""
        with self._lock:
            self._publisher.begin_game()
            self.publish()

    def end_admissions(self) -> None:
        """Delete the admissions whose time is over; to be called once a second or so."""
        with self._lock:
            now_s = self._clock()
            over = {
                key: None
                for key, entry in self._entries.items()
                if key.startswith(ADMISSION) and has_ended(entry, now_s)
            }
            if over:
                self.document.change(over, who=SERVICE, what="the time of an admission is over", kind=Kind.SERVICE)
                self._take_over(self._settings_of(self._with(over)))

    def waiting_for_restart(self) -> list[str]:
        """Settings that were changed and take effect with the next start of the service."""
        running, wanted = flat(to_builtins(self._service.settings)), flat(to_builtins(self.settings))
        return sorted(
            key for key in running.keys() | wanted.keys() if running.get(key) != wanted.get(key) and not is_live(key)
        )

    def _step(self, target: Change | None, step: Callable[..., Change], verb: str, who: str, seen: int) -> Change:
        with self._lock:
            if target is not None:
                values = {entry.key: entry.before if verb == "undo" else entry.after for entry in target.entries}
                settings = self._judged(self._with(values), verb)
            try:
                change = step(who=who, seen=seen)
            except NothingToUndoError:
                raise RequestRefused(
                    HTTPStatus.CONFLICT, verb, found=f"nothing to {verb}", accepted="a change first"
                ) from None
            except ConflictError as conflict:
                raise _conflict(verb, conflict) from None
            self._take_over(settings)
            return change

    def _with(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """The entries as they are after a change."""
        return {key: value for key, value in {**self._entries, **values}.items() if value is not None}

    def _by_table(self, values: Mapping[str, Any]) -> Mapping[str, Any]:
        """The same change, in which each of the user's own tables has an entry of its own: one place for each."""
        found = dict(values)
        for key in map(setting, OF_WHOLE):
            tables = found.get(key)
            if key in found and (tables is None or isinstance(tables, Mapping)):
                del found[key]
                found |= dict.fromkeys(entry for entry in self._entries if entry.startswith(f"{key}."))
                found |= {f"{key}.{name}": table for name, table in (tables or {}).items()}
        return found

    def _judged(self, entries: Mapping[str, Any], what: str) -> Settings:
        try:
            return self._settings_of(entries)
        except SettingsError as error:
            key = error.asked.rpartition(": ")[2]
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                f"{what}: {key}",
                found=error.found,
                accepted=error.accepted,
                field=key,
            ) from None

    def _settings_of(self, entries: Mapping[str, Any]) -> Settings:
        overlay = overlay_from(entries, self.base, self._clock())
        return settings_from_layers(with_overlay(self._service.layers, overlay))

    def _take_over(self, settings: Settings) -> None:
        self._entries = self.document.entries()
        self.settings = settings
        self.publish()

    def publish(self) -> None:
        """Tell the processes what holds now; to be called as well when a key is new."""
        slugs = {color.value: self._entries.get(plays(color)) for color in Team}
        keys = {color: digest for color, slug in slugs.items() if slug and (digest := self._key_digest(slug))}
        monitor_key = self._key_digest(MONITORS)
        self._publisher.publish(self.settings, self._service.settings, self.revision, keys, monitor_key)


def flat(table: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    """Values by dotted keys: tables within tables are opened, lists and the user's own tables are not."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        here = f"{path}{key}"
        if isinstance(value, Mapping) and value and here not in WHOLE and path.removesuffix(".") not in OF_WHOLE:
            found |= flat(value, f"{here}.")
        else:
            found[here] = value
    return found


WHOLE = frozenset(
    {
        *("colors.classes", "colors.samples", "protocol.letters", "camera.homography", "camera.lens"),
        *("mirror.blue", "mirror.yellow"),
    }
)
"""Tables that are changed as a whole."""
OF_WHOLE = frozenset({"mirror.robots"})
"""Tables of such tables, by names of the user's."""


def _conflict(what: str, conflict: ConflictError) -> RequestRefused:
    return RequestRefused(
        HTTPStatus.CONFLICT, what, found=str(conflict), accepted="the same change after a look at the newest state"
    )
