"""Rate limits: how often a sender may ask for something, and how often it is told what is wrong.

Datagrams of addresses without a session pass three checks, the cheapest first: the budget of their address, the
budget that all such addresses share, and then, for each command in the datagram, the budget of the address for
commands of that name. A session has budgets of its own. So a client that floods the server with one command can
still use the others, and its neighbors can use all of them.
"""

from collections import OrderedDict
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from vision_core.clock import NS_PER_S, Instant, after
from vision_core.protocol.error_codes import ErrorCode

AMPLIFICATION = 3
"""A reply to an address that is not admitted is at most so many times as long as its request (RFC 9000, 8.1)."""
COMPLAINT_PERIOD_S = 5.0
MAX_SOURCES = 4096
SHARES = 16
"""Addresses that a shared budget is divided among when there is not enough for all."""
DATAGRAM = "datagram"
"""The budget for datagrams, whatever they hold."""


class Rate(NamedTuple):
    """A steady rate, and how many may come at once."""

    rate_hz: float
    burst: int


COMMAND_RATE = Rate(20.0, 40)
"""For each command that is not named below, from one address or of one session."""
INIT_RATE = Rate(64.0, 64)
"""From one address: a computer that runs both teams, 32 robots, may repeat each init twice a second."""
DRIVE_RATE = Rate(120.0, 120)
"""Of one robot: so its driver may send a command for every image of a fast camera, and keeps its other budgets."""
SESSION_DATAGRAM_RATE = Rate(200.0, 400)
"""Datagrams of a client that has a session."""
INVALID = "invalid"
"""The budget for commands that cannot be decoded, inits with a mistake among them."""
RATES: Mapping[str, Rate] = MappingProxyType({DATAGRAM: Rate(100.0, 200), "init": INIT_RATE, INVALID: INIT_RATE})
"""For one address, or of one session."""


class TokenBucket:
    """Lets a burst pass, then a steady rate."""

    def __init__(self, rate: Rate) -> None:
        self._rate = rate
        self._tokens = float(rate.burst)
        self._filled_at: Instant | None = None

    def take(self, now: Instant, reserve: float = 0.0) -> bool:
        """Take a token; False when there is none above the reserve, a share of the burst, 0..1."""
        self._fill(now)
        if self._tokens < 1.0 + reserve * self._rate.burst:
            return False
        self._tokens -= 1.0
        return True

    def _fill(self, now: Instant) -> None:
        if self._filled_at is not None:
            gained = max(now - self._filled_at, 0) * self._rate.rate_hz / NS_PER_S
            self._tokens = min(self._tokens + gained, float(self._rate.burst))
        self._filled_at = now


class SharedBudget:
    """A budget for all addresses together, of which each of SHARES addresses is sure to get its share.

    Half of the tokens are reserved for addresses that have not used up their share, rate / SHARES. So a few addresses
    that ask without end cannot use up what the others need, and one address may use everything while no other asks.
    """

    RESERVE = 0.5

    def __init__(self, name: str, rate: Rate) -> None:
        """name: of the budget, by which an address keeps its own account of it."""
        self._name = f"share of {name}"
        self._bucket = TokenBucket(rate)
        self._share = Rate(rate.rate_hz / SHARES, max(round(self.RESERVE * rate.burst / SHARES), 1))

    def take(self, limiter: "RateLimiter", now: Instant) -> bool:
        """Take one token for an address; limiter: that of the address."""
        within_share = limiter.take(self._name, now, self._share)
        return self._bucket.take(now, 0.0 if within_share else self.RESERVE)


class RateLimiter:
    """The budgets of one address or one session: one for datagrams, one for each command, one for each error."""

    def __init__(self) -> None:
        self._buckets: dict[str, TokenBucket] = {}
        self._quiet_until: dict[ErrorCode, Instant] = {}

    def take(self, name: str, now: Instant, rate: Rate | None = None) -> bool:
        """May one more of this name pass? name: one of a bounded set; rate: in place of the one in RATES."""
        bucket = self._buckets.get(name)
        if bucket is None:
            bucket = self._buckets[name] = TokenBucket(rate or RATES.get(name, COMMAND_RATE))
        return bucket.take(now)

    def may_complain(self, error: ErrorCode, now: Instant) -> bool:
        """May the sender be told this error? True at most once in 5 s for each error."""
        if now < self._quiet_until.get(error, now):
            return False
        self._quiet_until[error] = after(now, COMPLAINT_PERIOD_S)
        return True


class RateLimiterTable:
    """A rate limiter per address; the least recently used one is dropped beyond ``max_sources``."""

    def __init__(self, max_sources: int = MAX_SOURCES) -> None:
        self._max_sources = max_sources
        self._limiters: OrderedDict[str, RateLimiter] = OrderedDict()

    def __len__(self) -> int:
        return len(self._limiters)

    def of(self, host: str) -> RateLimiter:
        """The rate limiter of an address."""
        limiter = self._limiters.get(host)
        if limiter is None:
            limiter = self._limiters[host] = RateLimiter()
            if len(self._limiters) > self._max_sources:
                self._limiters.popitem(last=False)
        else:
            self._limiters.move_to_end(host)
        return limiter
