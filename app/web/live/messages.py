"""Makes the messages for open pages: each once for all pages, while a page has subscribed to its topic, at its rate."""

import asyncio
from collections.abc import Callable, Collection

from app.web.blackboard import Blackboard
from app.web.configuration.configuration import Configuration
from app.web.health.monitor import HealthMonitor
from app.web.live import topics
from app.web.live.delay import History, Message, is_delayed
from app.web.live.overlays import LAYER_OF, Overlays
from app.web.reports.field import Outlines
from vision_core.clock import Instant, seconds_between
from vision_core.protocol.edge_codes import edge_codes
from vision_core.rtdb import records
from vision_core.types.objects import Team

EVERY_S = {
    "status": 0.25,
    "world": 0.0,
    "views": 0.0,
    "picture": 1.0 / 15.0,
    "sightings": 1.0 / 15.0,
    "timing": 0.5,
    "log": 0.25,
    **dict.fromkeys(LAYER_OF, 0.2),
}
"""Shortest time between two messages of a topic [s]; 0: with every frame."""
TOPICS = tuple(EVERY_S)
OPERATORS_TOPICS = frozenset({"log"})
"""Topics with addresses of people."""
ONLY_NEW = frozenset({"picture", "log", *LAYER_OF})
"""Topics without a message when nothing is new."""
VIEW_PREFIX = "view/"
MAX_SILENCE_S = 0.25
"""A message of what comes with frames is made at least this often, so that its age is known."""
SLACK_S = 0.004
"""A message may be made this much before it is due: the loop's grid is as coarse as the frames."""


def is_topic(topic: str, numbers: int) -> bool:
    """Is there such a topic? numbers: robots of a team."""
    return topic in EVERY_S or robot_of(topic, numbers) is not None


def robot_of(topic: str, numbers: int) -> tuple[Team, int] | None:
    """The robot of a topic "view/blue/3"; None for another topic."""
    if not topic.startswith(VIEW_PREFIX):
        return None
    color, _, number = topic.removeprefix(VIEW_PREFIX).partition("/")
    if color not in tuple(Team) or not number.isdecimal() or not 1 <= int(number[:3]) <= numbers:
        return None
    return Team(color), int(number)


class LiveMessages:
    """Makes and keeps the messages of each topic."""

    def __init__(
        self, blackboard: Blackboard, monitor: HealthMonitor, configuration: Configuration, overlays: Overlays
    ) -> None:
        self._blackboard = blackboard
        self._overlays = overlays
        self._monitor = monitor
        self._configuration = configuration
        self._outlines = Outlines(blackboard.service.settings)
        self._codes = edge_codes(blackboard.service.settings.protocol.letters)
        self._sources: dict[str, int] = {}
        """Number of the record that the newest message of a topic was made of."""
        self._made = 0
        self._histories: dict[str, History] = {}

    @property
    def delay_s(self) -> float:
        """How late viewers see where things are [s]; 0 while no match is played."""
        match = self._configuration.settings.match
        return match.viewer_delay_s if match.mode == "match" else 0.0

    def of(self, topic: str, *, delayed: bool) -> Message | None:
        """The newest message of a topic that somebody may have; delayed: he is a viewer."""
        history = self._histories.get(topic)
        if history is None:
            return None
        delay_s = self.delay_s if delayed and is_delayed(topic) else 0.0
        return history.before(self._blackboard.now(), delay_s) if delay_s else history.newest()

    def forget(self, subscribed: Collection[str]) -> None:
        """Drop the messages of topics without a subscriber: they would be old for the next one."""
        for topic in self._histories.keys() - set(subscribed):
            del self._histories[topic]

    async def make(self, subscribed: Collection[str], pages: int) -> bool:
        """Make the messages of the topics that have news; False when none has. pages: number of open pages."""
        now = self._blackboard.now()
        self._overlays.look(subscribed, now)
        due = [topic for topic in subscribed if self._is_due(topic, now)]
        fresh = False
        for topic in due:
            content = await self._made_of(topic, pages)
            if content is not None:
                self._publish(topic, content)
                fresh = True
        return fresh

    def _is_due(self, topic: str, now: Instant) -> bool:
        history = self._histories.get(topic)
        if history is None:
            return True
        age_s = seconds_between(history.newest().made, now)
        if topic in ("status", "timing"):
            return age_s >= EVERY_S[topic] - SLACK_S
        is_new = self._source(topic) != self._sources.get(topic)
        return (is_new and age_s >= EVERY_S.get(topic, 0.0) - SLACK_S) or (
            age_s >= MAX_SILENCE_S and topic not in ONLY_NEW
        )

    def _source(self, topic: str) -> int:
        """Number of the record that a topic is made of."""
        if topic == "picture":
            return self._blackboard.picture_number
        if topic == "log":
            return self._blackboard.log_number
        if topic in LAYER_OF:
            return self._overlays.number
        if topic == "sightings":
            return self._blackboard.sequence_of(records.sightings)
        if topic == "world":
            return self._blackboard.sequence_of(records.WORLD)
        return self._blackboard.sequence_of(records.VIEWS)

    async def _made_of(self, topic: str, pages: int) -> bytes | str | None:
        if topic not in ("status", "timing"):
            self._sources[topic] = self._source(topic)
        make: dict[str, Callable[[], bytes | str | None]] = {
            "picture": self._picture,
            "timing": self._timing,
            "log": self._log,
            "status": lambda: self._status(pages),
            **dict.fromkeys(LAYER_OF, lambda: self._overlay(topic)),
        }
        if topic in make:
            return await asyncio.to_thread(make[topic])
        return self._small(topic)

    def _small(self, topic: str) -> bytes | str:
        """Messages that take less than a millisecond."""
        boot, now = self._blackboard.service.boot, self._blackboard.now()
        if topic == "world":
            return topics.world_message(boot, now, self._blackboard.read_one(records.WORLD))
        if topic == "sightings":
            return topics.sightings_message(self._blackboard.read(), self._outlines)
        views = self._blackboard.read_one(records.VIEWS)
        robot = robot_of(topic, self._configuration.settings.match.numbers)
        if robot is None:
            return topics.views_message(boot, views)
        return topics.robot_view_message(topic, boot, now, views, robot, self._codes)

    def _picture(self) -> bytes | None:
        picture = self._blackboard.picture()
        return None if picture is None else topics.picture_message(picture, self._blackboard.service.boot)

    def _overlay(self, topic: str) -> str | None:
        overlay = self._overlays.newest()
        content = None if overlay is None else getattr(overlay, LAYER_OF[topic])
        if overlay is None or content is None:
            return None
        return topics.overlay_message(topic, self._blackboard.service.boot, self._blackboard.now(), overlay, content)

    def _timing(self) -> str:
        return topics.timing_message(self._blackboard.read(), self._blackboard.timings())

    def _log(self) -> str:
        boot, now = self._blackboard.service.boot, self._blackboard.now()
        return topics.log_message(boot, now, self._blackboard.log())

    def _status(self, pages: int) -> str:
        return topics.status_message(self._blackboard.read(), self._monitor, self._configuration, pages)

    def _publish(self, topic: str, content: bytes | str) -> None:
        self._made += 1
        message = Message(self._made, self._blackboard.now(), content)
        self._histories.setdefault(topic, History()).add(message, self.delay_s if is_delayed(topic) else 0.0)
