"""Keeps the record of fairness (``types.fairness``): counts each frame, and begins a new record when one is due."""

import math
import secrets

import numpy as np
from numpy.typing import NDArray

from vision_core.clock import NS_PER_US, Instant
from vision_core.native.kernels import kernel
from vision_core.net.delivery_rows import SENT
from vision_core.settings.schema import MatchSettings
from vision_core.timing.histogram import BINS, BITS, FIRST_BIT, PER_OCTAVE
from vision_core.types.fairness import FAIRNESS, MATCH, MAX_ROBOTS, NAME_BYTES, PRACTICE, REQUEST
from vision_core.types.tables import MAX_NUMBERS, Table

SEED_BITS = 64


@kernel
def note_frame(record: Table, rows: Table, order: NDArray[np.int64], count: int, at: int) -> None:
    """Count a frame that was sent.

    record: FAIRNESS, shape (1,); rows: DELIVERY; order: the rows in the order of sending, of which count are valid;
    at: grab of the frame [ns]. A frame with more datagrams than robots can have is not counted.
    """
    if count > MAX_ROBOTS:
        return
    whole = record[0]
    first_place, first_at = count * (count - 1) // 2, rows[order[0]].sent_at
    blue = sent_blue = sent_yellow = 0
    blue_us = yellow_us = squares = 0.0
    for place in range(count):
        row = rows[order[place]]
        robot = whole.robots[row.robot]
        robot.sessions += row.noted_in != whole.began
        row.noted_in = whole.began
        robot.places[first_place + place] += np.uint32(1)
        is_blue = row.robot < MAX_NUMBERS
        blue += is_blue
        if row.result != SENT:
            robot.dropped += 1
            continue
        lag_ns = row.sent_at - at
        lag_us = lag_ns / NS_PER_US
        robot.sent += 1
        robot.lag_us_sum += lag_us
        robot.lag_us2_sum += lag_us * lag_us
        robot.lags[lag_bin(lag_ns)] += np.uint32(1)
        later_us = (row.sent_at - first_at) / NS_PER_US
        squares += later_us * later_us
        if is_blue:
            sent_blue += 1
            blue_us += later_us
        else:
            sent_yellow += 1
            yellow_us += later_us
    whole.frames[count] += 1
    whole.blue[count] += blue
    whole.blue2[count] += blue * blue
    sent = sent_blue + sent_yellow
    if sent > 1:
        whole.spread_freedom += sent - 1
        whole.spread_us2_sum += squares - (blue_us + yellow_us) ** 2 / sent
    if sent_blue > 0 and sent_yellow > 0:
        difference_us = blue_us / sent_blue - yellow_us / sent_yellow
        whole.compared += 1
        whole.difference_us_sum += difference_us
        whole.difference_us2_sum += difference_us * difference_us


@kernel
def lag_bin(duration_ns: int) -> int:
    """``timing.histogram.bin_of`` in compiled code."""
    if duration_ns < 1 << FIRST_BIT:
        return 0
    bit = math.frexp(float(duration_ns))[1] - 1
    return min(1 + ((bit - FIRST_BIT) << BITS) + ((duration_ns >> (bit - BITS)) & (PER_OCTAVE - 1)), BINS - 1)


class FairnessRecord:
    """The record in its memory, which compiled code fills."""

    def __init__(self, boot: Instant, seed: int | None = None) -> None:
        """A record of practice. seed: of the order of sending; None: the system draws one for each record."""
        self._seed = seed
        self.table: Table = np.zeros(1, dtype=FAIRNESS)
        """FAIRNESS, shape (1,)."""
        self._begin(PRACTICE, boot, 0.0)
        self.table["boot"] = boot

    @property
    def memory(self) -> memoryview:
        """The memory of the table."""
        return self.table.view(np.uint8).data

    @property
    def has_begun(self) -> bool:
        """False before the first ``follow``."""
        return bool(self.table["began_s"][0] > 0.0)

    def load(self, memory: bytes) -> None:
        """Go on with the record of an earlier process of the same start. Raises ValueError if it is of another size."""
        loaded = np.frombuffer(memory, dtype=FAIRNESS, count=1)
        if loaded["boot"] == self.table["boot"]:
            self.table[:] = loaded

    def follow(self, match: MatchSettings, asked: Instant, now: Instant, now_s: float) -> bytes | None:
        """Begin a new record when a match begins or ends, when others play, and when the operator has asked for one.

        asked: when the operator last did; now_s: time of day [s since 1970]. Returns the record that has ended; None
        while it goes on, and when it has not counted any frame.
        """
        whole = self.table[0]
        is_match = match.mode == "match"
        names = tuple(_fitting(name) for name in (match.blue_name, match.yellow_name))
        is_same = bool(whole["is_match"]) == is_match and (whole["blue_name"], whole["yellow_name"]) == names
        is_asked = asked > whole["began"]
        if is_same and not is_asked and self.has_begun:
            return None
        whole["ended_s"] = now_s
        ended = bytes(self.memory) if whole["frames"].any() else None
        self._begin(REQUEST if is_asked else MATCH if is_match else PRACTICE, now, now_s)
        whole["is_match"], whole["blue_name"], whole["yellow_name"] = is_match, *names
        return ended

    def _begin(self, reason: int, now: Instant, now_s: float) -> None:
        whole, boot = self.table[0], self.table[0]["boot"]
        self.table[:] = np.zeros(1, dtype=FAIRNESS)
        whole["boot"], whole["reason"], whole["began"], whole["began_s"] = boot, reason, now, now_s
        whole["seed"] = secrets.randbits(SEED_BITS) if self._seed is None else self._seed


def _fitting(name: str) -> bytes:
    """A team's name as the record holds it."""
    return name.encode()[:NAME_BYTES].decode(errors="ignore").encode().rstrip(b"\0")
