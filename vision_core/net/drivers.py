"""The newest command of each robot's driver, as the record ``drives`` says it.

The session of a robot is its driver. The row of a robot is empty until its client sends a command, and again when its
session ends: then the robot plays by itself.
"""

from collections.abc import Iterable

from vision_core.protocol.events import Driven, Event, SessionClosed
from vision_core.protocol.lifecycle import Session
from vision_core.types.drives import drives_from, no_drives
from vision_core.types.tables import TEAM_NUMBER, Table


class Drivers:
    """Collects commands. Its memory is the record."""

    def __init__(self, sessions: Iterable[Session] = (), record: bytes | None = None) -> None:
        """sessions, record: those of an earlier process; only the rows of sessions that go on are kept."""
        self._drives = no_drives()
        if record is not None:
            earlier = drives_from(record)
            for session in sessions:
                self._drives[_place(session)] = earlier[_place(session)]

    @property
    def record(self) -> bytes:
        """The rows of all robots."""
        return self._drives.tobytes()

    def note(self, events: Iterable[Event]) -> bool:
        """Take over what clients ask for; has the record changed?"""
        changed = False
        for event in events:
            match event:
                case Driven(session):
                    self._take(self._drives[_place(session)], event)
                    changed = True
                case SessionClosed(session) if self._drives[_place(session)]["at"]:
                    self._drives[_place(session)] = 0
                    changed = True
        return changed

    @staticmethod
    def _take(row: Table, driven: Driven) -> None:
        drive = driven.drive
        row["at"], row["dribbles"] = driven.at, drive.dribble
        row["vx_m_s"], row["vy_m_s"], row["turn_rad_s"] = drive.vx_m_s, drive.vy_m_s, drive.turn_rad_s
        if drive.kick_m_s:
            row["kicked_at"], row["kick_m_s"] = driven.at, drive.kick_m_s


def _place(session: Session) -> tuple[int, int]:
    return TEAM_NUMBER[session.team], session.number - 1
