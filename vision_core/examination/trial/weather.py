"""What happens to datagrams on their way to the client."""

import heapq
import itertools
import random
from dataclasses import dataclass

from vision_core.clock import Instant, after


@dataclass(frozen=True, slots=True)
class Weather:
    """Shares of the datagrams, 0..1."""

    lost: float = 0.0
    repeated: float = 0.0
    late: float = 0.0
    late_s: float = 0.0
    """Greatest delay of those that are late: others overtake them."""


FAIR = Weather()
FOUL = Weather(lost=0.3, repeated=0.1, late=0.2, late_s=0.08)
CUT = Weather(lost=1.0)


class Way:
    """Datagrams under way, in the order in which they arrive."""

    def __init__(self, seed: int) -> None:
        self.weather = FAIR
        self._random = random.Random(seed)  # noqa: S311 (losses, no secrets)
        self._order = itertools.count()
        self._under_way: list[tuple[Instant, int, bytes]] = []

    def put(self, data: bytes, now: Instant) -> None:
        """A datagram begins its way, or is lost."""
        weather = self.weather
        if self._random.random() < weather.lost:
            return
        for _ in range(1 + (self._random.random() < weather.repeated)):
            late_s = self._random.random() * weather.late_s if self._random.random() < weather.late else 0.0
            heapq.heappush(self._under_way, (after(now, late_s), next(self._order), data))

    def arrived(self, now: Instant) -> list[bytes]:
        """Those that arrive by now."""
        found = []
        while self._under_way and self._under_way[0][0] <= now:
            found.append(heapq.heappop(self._under_way)[2])
        return found

    def clear(self) -> None:
        """All are lost."""
        self._under_way.clear()
