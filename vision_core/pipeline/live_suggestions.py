"""What the slow search for shapes suggests just now, as the service's record has it."""

import numpy as np

from vision_core.clock import Instant
from vision_core.objects.robots.confirmation_buffers import SUGGESTED
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.suggestions import Suggestions
from vision_core.rtdb.items import ItemReader
from vision_core.types.suggestions import LiveSuggestions


def live_from(suggestions: Suggestions) -> LiveSuggestions:
    """As a record holds them."""
    blue, red, light = suggestions.plain.tolist()
    return LiveSuggestions((blue, red, light), tuple(suggestions.poses.tolist()))


class SuggestedRobots:
    """Makes a perception look for robots where the record says."""

    def __init__(self, perception: Perception, suggestions: ItemReader[LiveSuggestions]) -> None:
        self._perception, self._suggestions = perception, suggestions
        self._used = 0

    def refresh(self, now: Instant) -> None:
        """Look from the next image on where the newest record says."""
        if self._suggestions.sequence == self._used:
            return
        self._used = self._suggestions.sequence
        if (live := self._suggestions.read(now)) is not None:
            poses = np.array(list(live.value.poses), dtype=SUGGESTED)
            self._perception.suggest(Suggestions(np.array(live.value.plain), poses))
