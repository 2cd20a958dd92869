"""The live connection of the page: ``/live``, a WebSocket.

The page says "next" (any message), the service answers with the newest **turn** that the page has not seen,
as soon as there is one: a binary message with the picture if it is a new one, then a text message with
everything else. So one turn at most is under way to a page, however slow it or its network is, and what
it gets is the newest there is: newest wins, and no queue grows anywhere. A page that says nothing for
PATIENCE_S is dropped.

Turns are made at RATE_HZ while somebody watches, once for all pages; the JPEG is encoded in a thread.

Picture message, little-endian: u32 number of the frame, f64 instant of its grab [s since the start of the
service], then a JPEG. State message: JSON, see ``State``.
"""

import asyncio
import struct
import time
from dataclasses import dataclass

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect

from app.blackboard import Blackboard, Picture
from app.field_report import Outlines, Points
from app.reports import status_from
from vision_core.clock import Instant, seconds_between
from vision_core.opencv import encode_jpeg, shrink
from vision_core.rtdb.records import Timed
from vision_core.types.objects import Obstacles, Sightings
from vision_core.types.tracks import World
from vision_core.types.views import Views

RATE_HZ = 15.0
LONGEST_SILENCE_S = 0.25
"""A turn is made after that even when nothing was written, since ages and readiness change by themselves."""
PATIENCE_S = 5.0
MOST_PAGES = 20
LARGEST_WIDTH_PX = 960
JPEG_QUALITY = 75
TRY_LATER = 1013
TOO_SLOW = 1008
PICTURE_HEADER = struct.Struct("<Id")


@dataclass(frozen=True, slots=True)
class State:
    """What the page shows beside the picture. Bytes travel as base64."""

    now_s: float
    """Since the start of the service."""
    pages: int
    status: dict[str, object]
    """The same as /api/v1/status."""
    sightings: Timed[Sightings] | None
    outlines_px: list[Points]
    """In the picture, in the order of the sightings' robots; the first point is where the heading points to."""
    obstacles: Timed[Obstacles] | None
    """As seen in one picture; looked for less often than robots."""
    obstacle_outlines_px: list[Points]
    """In the picture, in the order of ``obstacles``."""
    world: Timed[World] | None
    views: Timed[Views] | None


@dataclass(frozen=True, slots=True)
class Turn:
    """What every page is sent."""

    picture_number: int
    picture: bytes
    """Empty before the first."""
    state: str


@dataclass(slots=True)
class Work:
    """What was done since it was last asked for."""

    sent: int
    """Messages since the start."""
    durations_s: list[float]
    """Of making turns."""


class Live:
    """Makes turns and sends them to the pages that are open."""

    def __init__(self, blackboard: Blackboard) -> None:
        self._blackboard = blackboard
        self._outlines = Outlines(blackboard.service.settings)
        self._pages: set[WebSocket] = set()
        self._watched = asyncio.Event()
        self._turn: Turn | None = None
        self._next = asyncio.Event()
        self._sequences: tuple[int, ...] = ()
        self._made_s = 0.0
        self.work = Work(0, [])

    @property
    def pages(self) -> int:
        """How many pages are open."""
        return len(self._pages)

    async def run(self) -> None:
        """Make turns for ever, on a grid in time, while somebody watches."""
        loop = asyncio.get_running_loop()
        while True:
            await self._watched.wait()
            await self._make_turn()
            await asyncio.sleep(1.0 / RATE_HZ - loop.time() % (1.0 / RATE_HZ))

    async def watch(self, page: WebSocket) -> None:
        """Serve one page until it leaves."""
        await page.accept()
        if len(self._pages) >= MOST_PAGES:
            await page.close(TRY_LATER, f"{MOST_PAGES} pages are open already; close one of them")
            return
        if not self._pages:
            self._turn = None  # it is from when somebody last watched
        self._pages.add(page)
        self._watched.set()
        try:
            await self._send_turns(page)
        except WebSocketDisconnect:
            pass
        except TimeoutError:
            await page.close(TOO_SLOW, f"the page has not asked for anything for {PATIENCE_S:.0f} s")
        finally:
            self._pages.discard(page)
            if not self._pages:
                self._watched.clear()

    async def _send_turns(self, page: WebSocket) -> None:
        seen: Turn | None = None
        shown = 0
        while True:
            async with asyncio.timeout(PATIENCE_S):
                if (await page.receive())["type"] == "websocket.disconnect":
                    return
            seen = await self._newer_than(seen)
            async with asyncio.timeout(PATIENCE_S):
                if seen.picture_number != shown:
                    shown = seen.picture_number
                    await page.send_bytes(seen.picture)
                    self.work.sent += 1
                await page.send_text(seen.state)
                self.work.sent += 1

    async def _newer_than(self, seen: Turn | None) -> Turn:
        """The newest turn, as soon as it is another one than the page has seen."""
        while self._turn is None or self._turn is seen:
            await self._next.wait()
        return self._turn

    async def _make_turn(self) -> None:
        """Publish a turn if anything has changed."""
        begun_s = time.monotonic()
        before = self._turn
        number = self._blackboard.picture_number
        fresh = before is None or number != before.picture_number
        silent_s = begun_s - self._made_s
        if not fresh and self._blackboard.sequences == self._sequences and silent_s < LONGEST_SILENCE_S:
            return
        picture = await asyncio.to_thread(self._encoded_picture) if fresh and number else None
        if picture is None:
            picture = (before.picture_number, before.picture) if before else (0, b"")
        self._sequences = self._blackboard.sequences
        self._turn = Turn(*picture, self._encoded_state())
        self._made_s = begun_s
        self.work.durations_s.append(time.monotonic() - begun_s)
        reached, self._next = self._next, asyncio.Event()
        reached.set()

    def _encoded_picture(self) -> tuple[int, bytes] | None:
        picture = self._blackboard.picture()
        if picture is None:
            return None
        return picture.number, picture_message(picture, self._blackboard.service.boot)

    def _encoded_state(self) -> str:
        readings = self._blackboard.read()
        sightings, obstacles = readings.sightings, readings.obstacles
        state = State(
            now_s=seconds_between(readings.service.boot, readings.now),
            pages=len(self._pages),
            status=status_from(readings).model_dump(),
            sightings=sightings,
            outlines_px=self._outlines.of_robots(sightings.value.robots) if sightings else [],
            obstacles=obstacles,
            obstacle_outlines_px=self._outlines.of_obstacles(obstacles.value.obstacles) if obstacles else [],
            world=readings.world,
            views=readings.views,
        )
        return msgspec.json.encode(state).decode()


def picture_message(picture: Picture, boot: Instant) -> bytes:
    """The binary message of a picture, small enough for a page."""
    header = PICTURE_HEADER.pack(picture.number & 0xFFFFFFFF, seconds_between(boot, picture.grabbed))
    return header + encode_jpeg(shrink(picture.pixels, LARGEST_WIDTH_PX), JPEG_QUALITY)
