"""What clients' programs ask of the robots, as the physics needs it: who drives which robot, and for how long."""

from collections.abc import Sequence

import numpy as np

from vision_core.capture.synthetic.bodies import Drivers, no_drivers
from vision_core.clock import NS_PER_MS, NS_PER_S, Instant
from vision_core.settings.schema import DriveSettings, MatchSettings
from vision_core.types.drives import Drives
from vision_core.types.objects import Team
from vision_core.types.tables import TEAM_NUMBER

KICK_WAIT_S = 0.2
"""For so long after its command a robot that was told to kick waits for the ball."""


class DriverDesk:
    """Keeps the newest commands of all drivers. Robots are those of the world, in its order."""

    def __init__(self, settings: DriveSettings, worn: Sequence[tuple[Team, int]]) -> None:
        """worn: team and marker id of each robot."""
        self._worn = worn
        self._silence_ns = settings.silence_ms * NS_PER_MS
        two_wheels = settings.wheels == "two"
        limits = np.array([settings.acceleration_m_s2, settings.turn_acceleration_rad_s2, float(two_wheels)])
        self.drivers: Drivers = no_drivers(len(worn), limits)
        self.silent = np.zeros(len(worn), dtype=np.bool_)
        """Whose driver has sent nothing for too long, so that the robot stands."""
        self.numbers = np.zeros(len(worn), dtype=np.int64)
        """Of the robots that have a driver."""
        self._kicked_at = np.zeros(len(worn), dtype=np.int64)

    def take(self, drives: Drives, match: MatchSettings, now: Instant) -> None:
        """Follow the newest commands; a robot without one is driven by nobody. match: who wears which marker."""
        for robot, (team, worn) in enumerate(self._worn):
            ids = match.ids_of(team)
            number = ids.index(worn) + 1 if worn in ids else 0
            row = drives[TEAM_NUMBER[team], number - 1] if 0 < number <= drives.shape[1] else None
            if row is None or not row["at"]:
                self._release(robot)
            else:
                self.numbers[robot] = number
                self._follow(robot, row, now)

    def _release(self, robot: int) -> None:
        drivers = self.drivers
        drivers.driven[robot] = self.silent[robot] = False
        drivers.dribbles[robot], drivers.kicks_m_s[robot] = True, 0.0

    def _follow(self, robot: int, row: np.void, now: Instant) -> None:
        drivers, silent = self.drivers, now - row["at"] > self._silence_ns
        drivers.driven[robot], self.silent[robot] = True, silent
        drivers.wanted[robot] = 0.0 if silent else (row["vx_m_s"], row["vy_m_s"], row["turn_rad_s"])
        drivers.dribbles[robot] = not silent and row["dribbles"]
        if row["kicked_at"] > self._kicked_at[robot]:
            self._kicked_at[robot], drivers.kicks_m_s[robot] = row["kicked_at"], row["kick_m_s"]
        if now - row["kicked_at"] > KICK_WAIT_S * NS_PER_S:
            drivers.kicks_m_s[robot] = 0.0
