"""The record ``drives``: the newest command of each robot's driver, as a table of fixed size."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision_core.types.tables import MAX_NUMBERS, TEAMS

DRIVE = np.dtype(
    [
        ("at", np.int64), ("vx_m_s", np.float64), ("vy_m_s", np.float64), ("turn_rad_s", np.float64),
        ("dribbles", np.int64), ("kicked_at", np.int64), ("kick_m_s", np.float64),
    ]
)  # fmt: skip
"""When the command came, 0: the robot has no driver; the command, in the robot's frame; when the newest kick was asked
for, and its speed."""

Drives = NDArray[Any]
"""A row for each robot: DRIVE, shape (teams, numbers); row [team, n - 1] is that of number n."""
SIZE = len(TEAMS) * MAX_NUMBERS * DRIVE.itemsize
"""Of the record [bytes]."""


def no_drives() -> Drives:
    """A table in which no robot has a driver."""
    return np.zeros((len(TEAMS), MAX_NUMBERS), dtype=DRIVE)


def drives_from(record: bytes) -> Drives:
    """The table that a record holds, as a copy. Raises ValueError for a record of another size."""
    return np.frombuffer(record, dtype=DRIVE).reshape(len(TEAMS), MAX_NUMBERS).copy()
