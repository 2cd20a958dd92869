"""The record of fairness: how every robot was served since a match began. Fixed memory, so no frame allocates any.

A frame with n datagrams gives each robot a place 0..n-1 in the order of sending. Places are counted apart for every n,
because n changes when robots come and go: only then the expected counts are exact. Lags are from the grab of the image
to the end of the call that sent the datagram.
"""

import numpy as np

from vision_core.timing.histogram import BINS
from vision_core.types.objects import Team
from vision_core.types.tables import MAX_NUMBERS, TEAM_NUMBER, TEAMS, Table

MAX_ROBOTS = len(TEAMS) * MAX_NUMBERS
"""Robots that can have a session, and so datagrams of a frame."""
PLACES = MAX_ROBOTS * (MAX_ROBOTS + 1) // 2
"""Pairs of n and place: place p of n has index n (n - 1) / 2 + p."""
NAME_BYTES = 64
PRACTICE, MATCH, REQUEST = 0, 1, 2
"""Why a record began: nothing else was going on, a match began, the operator asked for it."""

SERVED = np.dtype(
    [
        ("sessions", np.int64), ("sent", np.int64), ("dropped", np.int64),
        ("lag_us_sum", np.float64), ("lag_us2_sum", np.float64),
        ("places", np.uint32, (PLACES,)), ("lags", np.uint32, (BINS,)),
    ]
)  # fmt: skip
"""How one robot was served, over all its sessions. lags: a histogram of ``timing.histogram``."""

FAIRNESS = np.dtype(
    [
        ("seed", np.uint64), ("boot", np.int64), ("began", np.int64), ("reason", np.int64), ("is_match", np.int64),
        ("began_s", np.float64), ("ended_s", np.float64),
        ("blue_name", f"S{NAME_BYTES}"), ("yellow_name", f"S{NAME_BYTES}"),
        ("frames", np.int64, (MAX_ROBOTS + 1,)),
        ("blue", np.int64, (MAX_ROBOTS + 1,)), ("blue2", np.int64, (MAX_ROBOTS + 1,)),
        ("compared", np.int64), ("difference_us_sum", np.float64), ("difference_us2_sum", np.float64),
        ("spread_freedom", np.int64), ("spread_us2_sum", np.float64),
        ("robots", SERVED, (MAX_ROBOTS,)),
    ]
)  # fmt: skip
"""The record. seed: of the order of sending (``net.sending_order``); boot, began: instants [ns]; reason: PRACTICE,
MATCH or REQUEST; began_s, ended_s: time of day [s since 1970], ended_s 0 while it goes on. frames, blue, blue2: by the
number n of a frame's datagrams: how many frames, the sum of blue's datagrams in each, and the sum of their squares.

compared: frames in which both teams were sent datagrams; difference_us: blue's mean lag minus yellow's in such a frame,
its sum and the sum of its squares; spread_us2_sum: sum of the squared distances of lags from the mean of their frame,
and how many of them are free. robots: by ``robot_index``."""


def robot_index(team: Team, number: int) -> int:
    """Index of a team's number 1..16 in a record, and its place in the order that is shuffled."""
    return TEAM_NUMBER[team] * MAX_NUMBERS + number - 1


def robot_of(index: int) -> tuple[Team, int]:
    """Team and number of an index."""
    return TEAMS[index // MAX_NUMBERS], index % MAX_NUMBERS + 1


def fairness_from(memory: bytes) -> Table:
    """A record's memory as FAIRNESS, shape (1,), read-only. Raises ValueError for memory of another size."""
    return np.frombuffer(memory, dtype=FAIRNESS, count=1)


def places_of(robots: Table, count: int) -> Table:
    """How often robots had each place in frames with so many datagrams. robots: SERVED, shape (...); (..., count)."""
    first = count * (count - 1) // 2
    places: Table = robots["places"][..., first : first + count]
    return places
