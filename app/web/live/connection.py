"""The live connection of a page: ``/live?topics=status,world``, a WebSocket. docs/live.md describes every topic.

The page requests an update by any message. As soon as there is news, the service answers with the newest message of
each topic that the page has not received, and ends the update with ``{"topic": "end"}``. So at most one update is on
its way to a page, however slow the page or its network is, and no queue grows. ``{"topics": [...]}`` takes other topics
from then on. A page that requests nothing for PATIENCE_S is disconnected, and so is one without news for so long.

Messages are made once for all pages (``app.web.live.messages``), on the grid of the frames.
"""

import asyncio
import json
from collections.abc import AsyncIterator, Coroutine, Iterable, MutableMapping
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from app.web.auth.addresses import address_of, share_of
from app.web.auth.credential import LOGIN_ENDED, until_login_ends
from app.web.auth.identity import Identity, Role, identity_of
from app.web.blackboard import Blackboard
from app.web.closing import close
from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import plays
from app.web.live.delay import Message, is_delayed
from app.web.live.messages import OPERATORS_TOPICS, TOPICS, LiveMessages, is_topic, robot_of
from app.web.live.topics import encoded
from vision_core.clock import seconds_between
from vision_core.scheduling.metrics import TaskMetrics
from vision_core.scheduling.releases import RAN, Grid

RATE_HZ = 30.0
PATIENCE_S = 5.0
DELAYED_PATIENCE_S = 70.0
"""A viewer of a match waits for his first message as long as he is delayed."""
MAX_PAGES = 40
FOR_OPERATORS = 8
"""More pages, of operators: however many strangers look, the operator finds room."""
PER_ADDRESS = 24
"""Pages of one address that is not the operator's."""
MAX_TOPICS = 16
TRY_LATER = 1013
POLICY_VIOLATION = 1008


class RefusedTopicsError(Exception):
    """A page asks for topics that there are not, or that are not for it."""


@dataclass(eq=False)
class _Page:
    socket: WebSocket
    identity: Identity
    address: str
    topics: tuple[str, ...] = ()
    seen: dict[str, int] = field(default_factory=dict)
    """Number of the last message of each topic that it was sent."""

    @property
    def is_operator(self) -> bool:
        return self.identity.role is Role.OPERATOR


class Live:
    """Sends updates to the open pages."""

    def __init__(
        self, blackboard: Blackboard, messages: LiveMessages, configuration: Configuration, metrics: TaskMetrics
    ):
        self._blackboard = blackboard
        self._messages = messages
        self._configuration = configuration
        self._metrics = metrics
        self._pages: set[_Page] = set()
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

    async def watch(self, socket: WebSocket) -> None:
        """Serve one page until it disconnects."""
        await socket.accept()
        page = _Page(socket, identity_of(socket), address_of(socket.scope))
        if (reason := self._full(page)) is not None:
            await close(socket, TRY_LATER, reason)
            return
        try:
            self._choose(page, socket.query_params.get("topics", "status").split(","))
        except RefusedTopicsError as refused:
            await close(socket, POLICY_VIOLATION, str(refused))
            return
        self._messages.forget(self._subscribed())
        self._pages.add(page)
        self._watched.set()
        try:
            if not await _finished_first(self._send_updates(page), until_login_ends(socket)):
                await close(socket, POLICY_VIOLATION, LOGIN_ENDED)
        except WebSocketDisconnect:
            pass
        except (TimeoutError, RefusedTopicsError) as fault:
            await close(socket, POLICY_VIOLATION, str(fault))
        finally:
            self._pages.discard(page)
            if not self._pages:
                self._watched.clear()

    def _full(self, page: _Page) -> str | None:
        """Why there is no room for a page; None: there is."""
        if self.pages >= MAX_PAGES + (FOR_OPERATORS if page.is_operator else 0):
            return f"{MAX_PAGES} pages are open already; close one of them"
        held = sum(share_of(other.address) == share_of(page.address) for other in self._pages)
        if held >= PER_ADDRESS and not page.is_operator:
            return f"{PER_ADDRESS} pages of your address are open already; close one of them"
        return None

    def _subscribed(self) -> list[str]:
        """Topics of all open pages, those that come first in an update first."""
        wanted = {topic for page in self._pages for topic in page.topics}
        return [topic for topic in TOPICS if topic in wanted] + sorted(wanted - set(TOPICS))

    def _choose(self, page: _Page, topics: Iterable[str]) -> None:
        """Give a page other topics. Raises RefusedTopicsError."""
        wanted = tuple(dict.fromkeys(filter(None, topics)))[: MAX_TOPICS + 1]
        numbers = self._configuration.settings.match.numbers
        unknown = [topic for topic in wanted if not is_topic(topic, numbers)]
        if unknown or len(wanted) > MAX_TOPICS:
            found = f"{len(wanted)} of them" if len(wanted) > MAX_TOPICS else unknown[0][:30]
            raise RefusedTopicsError(f"topics; found: {found}; accepted: {','.join(TOPICS)},view/COLOR/NUMBER")
        if not page.is_operator and (closed := OPERATORS_TOPICS.intersection(wanted)):
            raise RefusedTopicsError(f"only the operator may see {', '.join(closed)}")
        if page.identity.role is Role.TEAM:
            foreign = [topic for topic in wanted if is_delayed(topic) and not self._is_own(page.identity, topic)]
            if foreign:
                raise RefusedTopicsError(
                    f"{foreign[0][:30]} is not for your team; accepted: status, views of its robots"
                )
        page.topics = wanted

    def _is_own(self, identity: Identity, topic: str) -> bool:
        """Is a topic the view of a robot of somebody's own team?"""
        robot = robot_of(topic, self._configuration.settings.match.numbers)
        return robot is not None and self._configuration.entries.get(plays(robot[0])) == identity.team

    async def _send_updates(self, page: _Page) -> None:
        """Send updates until the page disconnects.

        Raises TimeoutError, with a reason for the page, when a wait takes longer than it may.
        """
        while True:
            async with _patience("the page has not requested an update", PATIENCE_S):
                while (chosen := _topics_in(await page.socket.receive())) is not None:
                    self._choose(page, chosen)
            late = bool(self._messages.delay_s) and self._is_delayed(page)
            async with _patience("there was no news", DELAYED_PATIENCE_S if late else PATIENCE_S):
                update = await self._news_of(page)
            self._choose(page, page.topics)  # the team may play the other color by now
            for topic, message in update.items():
                page.seen[topic] = message.number
                async with _patience("the page has not received what it was sent", PATIENCE_S):
                    await _send(page.socket, message.content)
            async with _patience("the page has not received what it was sent", PATIENCE_S):
                await _send(page.socket, encoded("end", self._blackboard.service.boot, self._blackboard.now()))

    def _is_delayed(self, page: _Page) -> bool:
        """Does somebody see a match late? Operators do not, nor does a team what its own robots see."""
        return page.identity.role is Role.VIEWER

    async def _news_of(self, page: _Page) -> dict[str, Message]:
        """The newest messages that a page has not received, as soon as there is one."""
        while True:
            found = {topic: self._messages.of(topic, delayed=self._is_delayed(page)) for topic in page.topics}
            news = {t: m for t, m in found.items() if m is not None and m.number != page.seen.get(t)}
            if news:
                return news
            await self._next.wait()


async def _finished_first(work: Coroutine[Any, Any, None], end: Coroutine[Any, Any, None]) -> bool:
    """Work until the end comes: has the work finished before it? Raises what the work raises."""
    working, ending = asyncio.create_task(work), asyncio.create_task(end)
    try:
        await asyncio.wait((working, ending), return_when=asyncio.FIRST_COMPLETED)
        if working.done():
            working.result()
        return working.done()
    finally:
        for task in (working, ending):
            task.cancel()
        await asyncio.gather(working, ending, return_exceptions=True)


def _topics_in(received: MutableMapping[str, Any]) -> list[str] | None:
    """The topics that a message chooses; None for a message that requests an update.

    Raises WebSocketDisconnect when the page has gone.
    """
    if received["type"] == "websocket.disconnect":
        raise WebSocketDisconnect
    text = received.get("text")
    if not isinstance(text, str) or not text.startswith("{"):
        return None
    try:
        topics = json.loads(text).get("topics")
    except (ValueError, RecursionError):
        return None
    return [str(topic) for topic in topics] if isinstance(topics, list) else None


async def _send(socket: WebSocket, content: bytes | str) -> None:
    """Send one message. Raises WebSocketDisconnect when the page is gone."""
    await (socket.send_bytes(content) if isinstance(content, bytes) else socket.send_text(content))


@asynccontextmanager
async def _patience(reason: str, seconds: float) -> AsyncIterator[None]:
    """Allow the block some time. Raises TimeoutError with the reason when it takes longer."""
    try:
        async with asyncio.timeout(seconds):
            yield
    except TimeoutError:
        raise TimeoutError(f"{reason} for {seconds:.0f} s") from None
