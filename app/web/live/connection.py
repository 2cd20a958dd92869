"""The live connection of the page: ``/live``, a WebSocket. ``/live?topics=timing`` takes some topics only.

The page requests an update by any message. The service answers, as soon as there is news, with the newest message of
each topic of the page (picture, timing, state, in this order) that the page has not received. An update is complete
with the message of the page's last topic. So at most one update is on its way to a page, however slow the page or its
network is, and no queue grows. A page that requests nothing for PATIENCE_S is disconnected, and so is a page whose
topics have no news for so long.

Messages are made at most RATE_HZ times a second, once for all pages, and only while a page has subscribed to their
topic (``app.web.live.messages``).
"""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

from starlette.websockets import WebSocket, WebSocketDisconnect

from app.web.auth.addresses import address_of, share_of
from app.web.auth.identity import Role, identity_of
from app.web.blackboard import Blackboard
from app.web.closing import close
from app.web.health.monitor import HealthMonitor
from app.web.live.messages import PICTURE, STATE, TOPICS, LiveMessages, Message
from vision_core.clock import seconds_between
from vision_core.scheduling.metrics import TaskMetrics
from vision_core.scheduling.releases import RAN, Grid

RATE_HZ = 15.0
PATIENCE_S = 5.0
MAX_PAGES = 40
FOR_OPERATORS = 8
"""More pages, of operators: however many strangers look, the operator finds room."""
PER_ADDRESS = 24
"""Pages of one address that is not the operator's."""
TRY_LATER = 1013
POLICY_VIOLATION = 1008
USUAL = f"{PICTURE},{STATE}"
"""Topics of a page that names none."""


class Live:
    """Sends updates to the open pages."""

    def __init__(self, blackboard: Blackboard, monitor: HealthMonitor, metrics: TaskMetrics) -> None:
        self._blackboard = blackboard
        self._metrics = metrics
        self._messages = LiveMessages(blackboard, monitor)
        self._pages: dict[WebSocket, tuple[str, ...]] = {}
        """The topics of each open page."""
        self._watched = asyncio.Event()
        self._next = asyncio.Event()

    @property
    def pages(self) -> int:
        """Number of open pages."""
        return len(self._pages)

    async def run(self) -> None:
        """Make messages for ever, on a grid in time, while pages are open."""
        grid = Grid(self._blackboard.service.boot, 1.0 / RATE_HZ)
        while True:
            if not self._watched.is_set():
                self._metrics.pause()
                grid.forget()
                await self._watched.wait()
            release = grid.take(self._blackboard.now())
            if release is not None and await self._messages.make(self._subscribed(), self.pages):
                reached, self._next = self._next, asyncio.Event()
                reached.set()
                self._metrics.count_run(release, RAN, self._blackboard.now())
            now = self._blackboard.now()
            await asyncio.sleep(max(seconds_between(now, grid.due(now)), 0.0))

    async def watch(self, page: WebSocket) -> None:
        """Serve one page until it disconnects."""
        await page.accept()
        asked = page.query_params.get("topics", USUAL).split(",")
        if not set(asked) <= set(TOPICS):
            await close(page, POLICY_VIOLATION, f"topics; found: {','.join(asked)[:40]}; accepted: {','.join(TOPICS)}")
            return
        if reason := self._no_room(page):
            await close(page, TRY_LATER, reason)
            return
        self._messages.forget(set(TOPICS) - self._subscribed())
        self._pages[page] = tuple(topic for topic in TOPICS if topic in asked)
        self._watched.set()
        try:
            await self._send_updates(page, self._pages[page])
        except WebSocketDisconnect:
            pass
        except TimeoutError as stuck:
            await close(page, POLICY_VIOLATION, str(stuck))
        finally:
            del self._pages[page]
            if not self._pages:
                self._watched.clear()

    def _no_room(self, page: WebSocket) -> str:
        """Why one more page has no room; empty when it has."""
        is_operator = identity_of(page).role is Role.OPERATOR
        if self.pages >= MAX_PAGES + (FOR_OPERATORS if is_operator else 0):
            return f"{MAX_PAGES} pages are open already; close one of them"
        share = share_of(address_of(page.scope))
        held = sum(share_of(address_of(each.scope)) == share for each in self._pages)
        if held >= PER_ADDRESS and not is_operator:
            return f"{PER_ADDRESS} pages of your address are open already; close one of them"
        return ""

    def _subscribed(self) -> set[str]:
        """Topics of all open pages."""
        return {topic for topics in self._pages.values() for topic in topics}

    async def _send_updates(self, page: WebSocket, topics: tuple[str, ...]) -> None:
        """Send updates until the page disconnects.

        Raises TimeoutError, with a reason for the page, when a wait takes longer than PATIENCE_S.
        """
        seen: dict[str, int] = {}
        while True:
            async with _patience("the page has not requested an update"):
                if (await page.receive())["type"] == "websocket.disconnect":
                    return
            async with _patience(f"there was no {topics[-1]}"):
                update = await self._newer_than(seen, topics)
            for topic, message in update.items():
                if seen.get(topic) != message.number:
                    seen[topic] = message.number
                    async with _patience("the page has not received what it was sent"):
                        await _send(page, message.content)

    async def _newer_than(self, seen: Mapping[str, int], topics: tuple[str, ...]) -> dict[str, Message]:
        """The newest messages of some topics, as soon as the last topic has one that was not seen."""
        while True:
            newest, last = self._messages.newest, topics[-1]
            if last in newest and newest[last].number != seen.get(last):
                return {topic: newest[topic] for topic in topics if topic in newest}
            await self._next.wait()


async def _send(page: WebSocket, content: bytes | str) -> None:
    """Send one message. Raises WebSocketDisconnect when the page is gone."""
    await (page.send_bytes(content) if isinstance(content, bytes) else page.send_text(content))


@asynccontextmanager
async def _patience(reason: str) -> AsyncIterator[None]:
    """Allow the block PATIENCE_S. Raises TimeoutError with the reason when it takes longer."""
    try:
        async with asyncio.timeout(PATIENCE_S):
            yield
    except TimeoutError:
        raise TimeoutError(f"{reason} for {PATIENCE_S:.0f} s") from None
