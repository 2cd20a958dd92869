"""How often somebody may try to log in: each address has a few tries, and fewer while many addresses fail.

Only its own failures keep an address out. So whoever guesses from elsewhere cannot lock the operator out, and what all
strangers together can try is bounded by hashing, two passwords at a time.
"""

import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

TRIES = 5
"""Failures of one address until it must wait."""
TRIES_UNDER_ATTACK = 1
"""The same, while more fail over all than OVERALL."""
FORGET_ONE_S = 30.0
"""One failure of an address is forgotten after this time."""
OVERALL = 60.0
OVERALL_FORGET_ONE_S = 3.0
MAX_ADDRESSES = 4096


@dataclass(slots=True)
class _Failures:
    """A number that shrinks with time."""

    count: float
    at: float

    def now(self, now: float, forget_one_s: float) -> float:
        """How many are left."""
        return max(self.count - (now - self.at) / forget_one_s, 0.0)


class Attempts:
    """Counts the failures of addresses; a try counts as one until it has succeeded."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """clock: tells the time [s]."""
        self._clock = clock
        self._addresses: OrderedDict[str, _Failures] = OrderedDict()
        self._overall = _Failures(0.0, clock())

    def wait_s(self, address: str) -> float:
        """How long an address has to wait for its next try; 0: it may try now."""
        now = self._clock()
        own = self._addresses.get(address)
        left = own.now(now, FORGET_ONE_S) if own else 0.0
        tries = TRIES if self._overall.now(now, OVERALL_FORGET_ONE_S) < OVERALL else TRIES_UNDER_ATTACK
        return max(left - (tries - 1), 0.0) * FORGET_ONE_S

    def begin(self, address: str) -> None:
        """A try begins: until it has succeeded it counts as a failure, so that many at once gain nothing."""
        now = self._clock()
        own = self._addresses.pop(address, None)
        self._addresses[address] = _Failures((own.now(now, FORGET_ONE_S) if own else 0.0) + 1.0, now)
        self._overall = _Failures(self._overall.now(now, OVERALL_FORGET_ONE_S) + 1.0, now)
        if len(self._addresses) > MAX_ADDRESSES:
            self._addresses.popitem(last=False)

    def succeeded(self, address: str) -> None:
        """The address has shown that it may: its failures are forgotten."""
        self._addresses.pop(address, None)
        now = self._clock()
        self._overall = _Failures(max(self._overall.now(now, OVERALL_FORGET_ONE_S) - 1.0, 0.0), now)
