"""The live connection of the page: ``/live``, a WebSocket. ``/live?topics=timing`` takes some topics only.

The page says "next" (any message), the service answers with the newest **turn** that the page has not seen,
as soon as there is one: of each of its topics (picture, timing, state) the newest message, in this order, where there
is a new one. A turn comes when the last of the page's topics has news, and ends with it. So one turn at most is under
way to a page, however slow it or its network is, and what it gets is the newest there is: newest wins, and no queue
grows anywhere. A page that says nothing for PATIENCE_S is dropped, and so is one for which there is no news so long.

Messages are made at RATE_HZ at most while somebody takes them, once for all pages (``app.web.live.messages``).
"""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

from starlette.websockets import WebSocket, WebSocketDisconnect

from app.web.blackboard import Blackboard
from app.web.health.monitor import HealthMonitor
from app.web.live.messages import PICTURE, STATE, TOPICS, LiveMessages, Message
from vision_core.clock import seconds_between
from vision_core.scheduling.metrics import TaskMetrics
from vision_core.scheduling.releases import RAN, Grid

RATE_HZ = 15.0
PATIENCE_S = 5.0
MAX_PAGES = 20
TRY_LATER = 1013
POLICY_VIOLATION = 1008
USUAL = f"{PICTURE},{STATE}"
"""Topics of who names none."""


class Live:
    """Has turns made and sends them to the pages that are open."""

    def __init__(self, blackboard: Blackboard, monitor: HealthMonitor, metrics: TaskMetrics) -> None:
        self._blackboard = blackboard
        self._metrics = metrics
        self._messages = LiveMessages(blackboard, monitor)
        self._pages: dict[WebSocket, tuple[str, ...]] = {}
        """Its topics, by page."""
        self._watched = asyncio.Event()
        self._next = asyncio.Event()

    @property
    def pages(self) -> int:
        """How many pages are open."""
        return len(self._pages)

    async def run(self) -> None:
        """Make turns for ever, on a grid in time, while somebody watches."""
        grid = Grid(self._blackboard.service.boot, 1.0 / RATE_HZ)
        while True:
            if not self._watched.is_set():
                self._metrics.pause()
                grid.forget()
                await self._watched.wait()
            release = grid.take(self._blackboard.now())
            if release is not None and await self._messages.make(self._taken(), self.pages):
                reached, self._next = self._next, asyncio.Event()
                reached.set()
                self._metrics.count_run(release, RAN, self._blackboard.now())
            now = self._blackboard.now()
            await asyncio.sleep(max(seconds_between(now, grid.due(now)), 0.0))

    async def watch(self, page: WebSocket) -> None:
        """Serve one page until it leaves."""
        await page.accept()
        asked = page.query_params.get("topics", USUAL).split(",")
        if not set(asked) <= set(TOPICS):
            await page.close(POLICY_VIOLATION, f"topics; found: {','.join(asked)[:40]}; accepted: {','.join(TOPICS)}")
            return
        if self.pages >= MAX_PAGES:
            await page.close(TRY_LATER, f"{MAX_PAGES} pages are open already; close one of them")
            return
        self._messages.forget(set(TOPICS) - self._taken())
        self._pages[page] = tuple(topic for topic in TOPICS if topic in asked)
        self._watched.set()
        try:
            await self._send_turns(page, self._pages[page])
        except WebSocketDisconnect:
            pass
        except TimeoutError as stuck:
            await page.close(POLICY_VIOLATION, str(stuck))
        finally:
            del self._pages[page]
            if not self._pages:
                self._watched.clear()

    def _taken(self) -> set[str]:
        """Topics that somebody takes."""
        return {topic for topics in self._pages.values() for topic in topics}

    async def _send_turns(self, page: WebSocket, topics: tuple[str, ...]) -> None:
        """Until the page leaves. Raises TimeoutError, with a reason for the page, when nothing moves any more."""
        seen: dict[str, int] = {}
        while True:
            async with _patience("the page has not asked for anything"):
                if (await page.receive())["type"] == "websocket.disconnect":
                    return
            async with _patience(f"there was no {topics[-1]}"):
                turn = await self._newer_than(seen, topics)
            for topic, message in turn.items():
                if seen.get(topic) != message.number:
                    seen[topic] = message.number
                    async with _patience("the page has not taken what it was sent"):
                        await _send(page, message.content)

    async def _newer_than(self, seen: Mapping[str, int], topics: tuple[str, ...]) -> dict[str, Message]:
        """The newest of some topics, as soon as the last of them is another one than was seen."""
        while True:
            newest, last = self._messages.newest, topics[-1]
            if last in newest and newest[last].number != seen.get(last):
                return {topic: newest[topic] for topic in topics if topic in newest}
            await self._next.wait()


async def _send(page: WebSocket, content: bytes | str) -> None:
    """Raises WebSocketDisconnect when the page is gone."""
    await (page.send_bytes(content) if isinstance(content, bytes) else page.send_text(content))


@asynccontextmanager
async def _patience(complaint: str) -> AsyncIterator[None]:
    """Wait for PATIENCE_S at most. Raises TimeoutError with the complaint."""
    try:
        async with asyncio.timeout(PATIENCE_S):
            yield
    except TimeoutError:
        raise TimeoutError(f"{complaint} for {PATIENCE_S:.0f} s") from None
