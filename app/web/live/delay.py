"""What viewers see of a match, and when: world, views, pictures and what is drawn over them some seconds late."""

from collections import deque
from dataclasses import dataclass

from vision_core.clock import Instant, seconds_between

DELAYED = frozenset({"world", "views", "picture", "sightings"})
"""Topics that tell where things are; ``view/...`` and ``overlay/...`` as well."""
PREFIXES = ("view/", "overlay/")


def is_delayed(topic: str) -> bool:
    """Does a topic tell where things are?"""
    return topic in DELAYED or topic.startswith(PREFIXES)


@dataclass(frozen=True, slots=True)
class Message:
    """A message of a topic."""

    number: int
    """Differs between any two messages of the topic."""
    made: Instant
    content: bytes | str


class History:
    """The messages of one topic, as far back as viewers are delayed."""

    def __init__(self) -> None:
        self._kept: deque[Message] = deque()

    def add(self, message: Message, keep_s: float) -> None:
        """Add the newest; what is older than the newest that is ``keep_s`` old is dropped."""
        self._kept.append(message)
        while len(self._kept) > 1 and seconds_between(self._kept[1].made, message.made) >= keep_s:
            self._kept.popleft()

    def newest(self) -> Message:
        """The newest message."""
        return self._kept[-1]

    def before(self, now: Instant, delay_s: float) -> Message | None:
        """The newest message that is at least so old; None: there is none."""
        old = (message for message in reversed(self._kept) if seconds_between(message.made, now) >= delay_s)
        return next(old, None)
