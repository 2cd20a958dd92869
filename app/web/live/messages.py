"""The messages for open pages: one per topic, made when the topic has news and a page has subscribed to it.

Picture: binary, little-endian: u32 number of the frame, f64 instant of its grab [s since the start of the service],
then a JPEG. State and timing: JSON with a key ``topic``, see ``State`` and ``Times``.
"""

import asyncio
import struct
import time
from collections.abc import Collection
from dataclasses import dataclass

import msgspec

from app.web.blackboard import Blackboard, Picture
from app.web.health.monitor import HealthMonitor
from app.web.reports.field import Outlines, Points
from app.web.reports.status import status_from
from app.web.reports.tasks import tasks_from
from app.web.reports.timing import timing_from
from vision_core.clock import Instant, seconds_between
from vision_core.native.opencv import encode_jpeg, shrink
from vision_core.rtdb import records
from vision_core.rtdb.items import Timed
from vision_core.types.objects import Obstacles, Sightings
from vision_core.types.tracks import World
from vision_core.types.views import Views

PICTURE, TIMING, STATE = "picture", "timing", "state"
TOPICS = (PICTURE, TIMING, STATE)
"""In the order in which they are sent."""
MAX_SILENCE_S = 0.25
"""A state is made at least this often, even when no record was written: ages and readiness change by themselves."""
TIMING_EVERY_S = 0.5
MAX_WIDTH_PX = 960
JPEG_QUALITY = 75
PICTURE_HEADER = struct.Struct("<Id")


@dataclass(frozen=True, slots=True)
class State:
    """What the page shows beside the picture. Bytes are encoded as base64."""

    topic: str
    now_s: float
    """Time since the start of the service [s]."""
    pages: int
    status: dict[str, object]
    """The same as /api/v1/status."""
    sightings: Timed[Sightings] | None
    outlines_px: list[Points]
    """Outlines in the picture, in the order of the sightings' robots; the first point is in the heading's direction."""
    obstacles: Timed[Obstacles] | None
    """As seen in one picture; they are searched less often than robots."""
    obstacle_outlines_px: list[Points]
    """Outlines in the picture, in the order of ``obstacles``."""
    world: Timed[World] | None
    views: Timed[Views] | None


@dataclass(frozen=True, slots=True)
class Times:
    """How the tasks run."""

    topic: str
    now_s: float
    """Time since the start of the service [s]."""
    tasks: list[dict[str, object]]
    """The same as /api/v1/tasks."""
    timing: dict[str, object]
    """The same as /api/v1/timing."""


@dataclass(frozen=True, slots=True)
class Message:
    """The newest message of a topic."""

    number: int
    """Differs between any two messages of the topic."""
    content: bytes | str


class LiveMessages:
    """Makes and keeps the newest message of each topic."""

    def __init__(self, blackboard: Blackboard, monitor: HealthMonitor) -> None:
        self._blackboard = blackboard
        self._monitor = monitor
        self._outlines = Outlines(blackboard.service.settings)
        self._sequences: tuple[int, ...] = ()
        self._made_s: dict[str, float] = {}
        self._made = 0
        self.newest: dict[str, Message] = {}
        """By topic."""

    def forget(self, topics: Collection[str]) -> None:
        """Drop the messages of topics without a subscriber: they would be old for the next one."""
        for topic in topics:
            self.newest.pop(topic, None)

    async def make(self, topics: Collection[str], pages: int) -> bool:
        """Make the messages of the topics that have news; False when none has. pages: number of open pages."""
        fresh = PICTURE in topics and await self._make_picture()
        if STATE in topics and (fresh or self._has_changed() or self._is_due(STATE, MAX_SILENCE_S)):
            self._sequences = self._blackboard.sequences
            self._publish(STATE, self._encoded_state(pages))
            fresh = True
        if TIMING in topics and self._is_due(TIMING, TIMING_EVERY_S):
            self._publish(TIMING, self._encoded_times())
            fresh = True
        return fresh

    def _has_changed(self) -> bool:
        return self._blackboard.sequences != self._sequences

    def _is_due(self, topic: str, every_s: float) -> bool:
        return topic not in self.newest or time.monotonic() - self._made_s[topic] >= every_s

    def _publish(self, topic: str, content: str) -> None:
        self._made += 1
        self._made_s[topic] = time.monotonic()
        self.newest[topic] = Message(self._made, content)

    async def _make_picture(self) -> bool:
        """Encode the newest image in a thread, if it differs from the last one."""
        before, number = self.newest.get(PICTURE), self._blackboard.picture_number
        if not number or (before is not None and before.number == number):
            return False
        message = await asyncio.to_thread(self._encoded_picture)
        if message is None:
            return False
        self.newest[PICTURE] = message
        return True

    def _encoded_picture(self) -> Message | None:
        picture = self._blackboard.picture()
        if picture is None:
            return None
        return Message(picture.number, picture_message(picture, self._blackboard.service.boot))

    def _encoded_state(self, pages: int) -> str:
        snapshot = self._blackboard.read()
        sightings, obstacles = snapshot.of(records.sightings), snapshot.of(records.obstacles)
        state = State(
            topic=STATE,
            now_s=seconds_between(snapshot.service.boot, snapshot.now),
            pages=pages,
            status=status_from(snapshot, self._monitor.judge(snapshot)).model_dump(),
            sightings=sightings,
            outlines_px=self._outlines.of_robots(sightings.value.robots) if sightings else [],
            obstacles=obstacles,
            obstacle_outlines_px=self._outlines.of_obstacles(obstacles.value.obstacles) if obstacles else [],
            world=snapshot.of(records.WORLD),
            views=snapshot.of(records.VIEWS),
        )
        return msgspec.json.encode(state).decode()

    def _encoded_times(self) -> str:
        snapshot = self._blackboard.read()
        timing = timing_from(self._blackboard.timings(), snapshot.camera.shutter_delay_ms)
        times = Times(
            topic=TIMING,
            now_s=seconds_between(snapshot.service.boot, snapshot.now),
            tasks=[task.model_dump() for task in tasks_from(snapshot)],
            timing=timing.model_dump(),
        )
        return msgspec.json.encode(times).decode()


def picture_message(picture: Picture, boot: Instant) -> bytes:
    """The binary message of a picture, reduced to the size of a page."""
    header = PICTURE_HEADER.pack(picture.number & 0xFFFFFFFF, seconds_between(boot, picture.grabbed))
    return header + encode_jpeg(shrink(picture.pixels, MAX_WIDTH_PX), JPEG_QUALITY)
