"""A stadium whose robots can be driven, and which keeps what they are told."""

from collections.abc import Mapping
from dataclasses import replace

from tests.net.serving import Stadium
from tests.protocol.samples import NO_KEYS
from vision_core.protocol.driving import DriveLimits
from vision_core.protocol.events import Driven, Event
from vision_core.types.objects import Team

LIMITS = DriveLimits(2.0, 2.0, 10.0, 5.0, dribbler=True)
NUMBERS = range(1, 4)


class Arena(Stadium):
    """Robots 1..3 of both teams can be driven."""

    def __init__(self, keys: Mapping[Team, str] = NO_KEYS) -> None:
        super().__init__()
        drives = {(team, number): LIMITS for team in Team for number in NUMBERS}
        self.restart(replace(self.rules, drives=drives, keys=keys))
        self.driven: list[Driven] = []
        self.send_frame()  # loads the kernels before a client waits

    def serve(self, patience_s: float = 1.0) -> list[Event]:
        events = super().serve(patience_s)
        self.driven += [event for event in events if isinstance(event, Driven)]
        return events
