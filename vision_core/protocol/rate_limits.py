"""How often somebody may ask, and be told off."""

from collections import OrderedDict

from vision_core.clock import NS_PER_S, Instant, after
from vision_core.protocol.error_codes import ErrorName

MESSAGES_PER_S = 20.0
MESSAGE_BURST = 40
COMPLAINT_PERIOD_S = 5.0
MAX_SOURCES = 4096


class TokenBucket:
    """Lets through a burst, then a steady rate."""

    def __init__(self, rate_hz: float, burst: int) -> None:
        self._rate_hz = rate_hz
        self._burst = float(burst)
        self._tokens = float(burst)
        self._filled: Instant | None = None

    def take(self, now: Instant) -> bool:
        """May one more pass?"""
        if self._filled is not None:
            gained = max(now - self._filled, 0) * self._rate_hz / NS_PER_S
            self._tokens = min(self._tokens + gained, self._burst)
        self._filled = now
        if self._tokens < 1.0:
            return False
        self._tokens -= 1.0
        return True


class Allowance:
    """What one source, or one session, may send, and how often it is told what is wrong."""

    def __init__(self) -> None:
        self.bucket = TokenBucket(MESSAGES_PER_S, MESSAGE_BURST)
        self._quiet_until: dict[ErrorName, Instant] = {}

    def may_complain(self, error: ErrorName, now: Instant) -> bool:
        """True at most once in 5 s for each error."""
        if now < self._quiet_until.get(error, now):
            return False
        self._quiet_until[error] = after(now, COMPLAINT_PERIOD_S)
        return True


class Sources:
    """An allowance per address; the least recently used is forgotten beyond 4096."""

    def __init__(self, most: int = MAX_SOURCES) -> None:
        self._most = most
        self._allowances: OrderedDict[str, Allowance] = OrderedDict()

    def __len__(self) -> int:
        return len(self._allowances)

    def of(self, host: str) -> Allowance:
        """The allowance of an address."""
        allowance = self._allowances.get(host)
        if allowance is None:
            allowance = self._allowances[host] = Allowance()
            if len(self._allowances) > self._most:
                self._allowances.popitem(last=False)
        else:
            self._allowances.move_to_end(host)
        return allowance
