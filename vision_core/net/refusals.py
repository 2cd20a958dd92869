"""Requests that were refused, for the operator: the same request again is counted, not listed again."""

from collections import Counter
from dataclasses import dataclass
from typing import TypeAlias

from vision_core.clock import Instant, seconds_between
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.events import RequestRefused
from vision_core.protocol.lifecycle import Peer
from vision_core.rtdb.infos import RefusedRequest
from vision_core.types.objects import Team

MAX_KEPT = 32
SHOWN_S = 30.0
WAITING_S = 600.0
"""Requests of addresses that are not admitted are shown for so long: somebody may still come and admit them."""

Key: TypeAlias = tuple[Peer, Team | None, int | None, ErrorCode]


@dataclass(slots=True)
class _Count:
    first: Instant
    last: Instant
    count: int = 0


class Refusals:
    """The newest refused requests, by sender, robot and reason."""

    def __init__(self) -> None:
        self._kept: dict[Key, _Count] = {}
        """In the order of their last request."""

    def note(self, refused: RequestRefused, now: Instant) -> None:
        """Count a request that was refused."""
        key = refused.peer, refused.team, refused.number, refused.error
        counted = self._kept.pop(key, None) or _Count(now, now)
        counted.last = now
        counted.count += 1
        self._kept[key] = counted
        if len(self._kept) > MAX_KEPT:
            self._drop_one()

    def recent(self, now: Instant) -> tuple[RefusedRequest, ...]:
        """Those that are worth showing, newest last; the others are forgotten."""
        for key, counted in tuple(self._kept.items()):
            shown_s = WAITING_S if key[3] is ErrorCode.NOT_ADMITTED else SHOWN_S
            if seconds_between(counted.last, now) > shown_s:
                del self._kept[key]
        return tuple(
            RefusedRequest(peer.host, peer.port, team, number, error.value, counted.first, counted.last, counted.count)
            for (peer, team, number, error), counted in self._kept.items()
        )

    def _drop_one(self) -> None:
        """Drop the oldest request of the address that has the most, so that no address pushes out all others."""
        by_address = Counter(key[0].host for key in self._kept)
        greediest, _ = by_address.most_common(1)[0]
        del self._kept[next(key for key in self._kept if key[0].host == greediest)]
