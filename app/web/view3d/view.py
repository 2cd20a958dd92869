"""Runs the 3D view while somebody looks, and relays browsers to it.

viser is imported, and its server started, when the first viewer comes. Nothing is computed without a viewer.
"""

import asyncio
import contextlib
from collections.abc import Callable
from typing import TYPE_CHECKING

from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from app.web.auth.credential import until_login_ends
from app.web.auth.identity import Role, identity_of
from app.web.blackboard import Blackboard
from app.web.closing import close
from app.web.configuration.configuration import Configuration
from vision_core.rtdb import records

if TYPE_CHECKING:
    from app.web.view3d.scene import Scene
    from app.web.view3d.server import GuardedServer

RATE_HZ = 12.0
MAX_VIEWERS = 4
MAX_MESSAGE = 64 * 1024
"""Longest message of a browser: it sends how its view turns, and what is clicked in the panel."""
MAX_MESSAGES_PER_S = 200.0
SHARE = b"ShareUrl"
"""Part of the messages by which viser would open a tunnel through a server in the internet; they are dropped."""
NORMAL, TRY_LATER, POLICY_VIOLATION = 1000, 1013, 1008
CHECK_S = 1.0
"""A viewer is disconnected this soon after a match has begun."""
FOR_OPERATORS = 2
"""More viewers, who are operators."""


class View3D:
    """The 3D view of one service."""

    def __init__(self, blackboard: Blackboard, configuration: Configuration) -> None:
        self._configuration = configuration
        self._blackboard = blackboard
        self._viewers = 0
        self._watched = asyncio.Event()
        self._starting = asyncio.Lock()
        self._server: GuardedServer | None = None
        self._scene: Scene | None = None

    @property
    def viewers(self) -> int:
        """How many look."""
        return self._viewers

    async def run(self) -> None:
        """Redraw the scene for as long as the web process runs, while somebody looks; then stop viser."""
        try:
            while True:
                await self._watched.wait()
                await asyncio.to_thread(self._redraw)
                await asyncio.sleep(1.0 / RATE_HZ)
        finally:
            if self._server is not None:
                self._server.stop()

    async def relay(self, page: WebSocket) -> None:
        """Connect a browser with viser until one of them ends the connection."""
        if not self._may_look(page):
            await page.accept()
            await close(page, POLICY_VIOLATION, "while a match is played, the 3D view is for the operator only")
            return
        is_operator = identity_of(page).role is Role.OPERATOR
        if self._viewers >= MAX_VIEWERS + (FOR_OPERATORS if is_operator else 0):
            await page.accept()
            await close(page, TRY_LATER, f"{MAX_VIEWERS} people look at the 3D view already")
            return
        self._viewers += 1
        self._watched.set()
        try:
            server = await self._started()
            if server.protocol not in page.scope.get("subprotocols", ()):
                await page.accept()
                await close(page, POLICY_VIOLATION, f"accepted: the page of this service, with {server.protocol}")
                return
            await _relay(page, server, lambda: self._may_look(page))
        finally:
            self._viewers -= 1
            if not self._viewers:
                self._watched.clear()

    def _may_look(self, page: WebSocket) -> bool:
        """The scene is not delayed, so in a match it is the operator's."""
        return self._configuration.settings.match.mode != "match" or identity_of(page).role is Role.OPERATOR

    async def _started(self) -> "GuardedServer":
        """viser's server; started when it is needed first."""
        async with self._starting:
            if self._server is None:
                await asyncio.to_thread(self._start)
            assert self._server is not None
            return self._server

    def _start(self) -> None:
        from app.web.view3d.scene import Scene
        from app.web.view3d.server import GuardedServer

        server = GuardedServer()
        self._scene = Scene(server.viser, self._blackboard.service.settings)
        self._server = server

    def _redraw(self) -> None:
        if self._scene is None:
            return
        snapshot = self._blackboard.read()
        world, views = snapshot.recent(records.WORLD), snapshot.recent(records.VIEWS)
        contours = snapshot.recent(records.contours)
        self._scene.show(
            world.value if world else None,
            views.value if views else None,
            contours.value.found if contours else None,
            self._configuration.settings,
        )


async def _relay(page: WebSocket, server: "GuardedServer", may_look: Callable[[], bool]) -> None:
    """Pass messages between a browser and viser until one of them ends the connection, or he may look no more."""
    from app.web.view3d.server import SECRET_HEADER

    async with connect(
        server.address,
        subprotocols=[Subprotocol(server.protocol)],
        additional_headers={SECRET_HEADER: server.secret},
        max_size=None,
        compression=None,
        proxy=None,
    ) as inner:
        await page.accept(subprotocol=server.protocol)
        ways = [asyncio.create_task(_to_viser(page, inner)), asyncio.create_task(_to_browser(inner, page))]
        ways.append(asyncio.create_task(until_login_ends(page)))
        done: set[asyncio.Task[None]] = set()
        open_ways = set(ways)
        while not done and may_look():
            done, open_ways = await asyncio.wait(ways, timeout=CHECK_S, return_when=asyncio.FIRST_COMPLETED)
        for way in open_ways:
            way.cancel()
        await asyncio.gather(*open_ways, return_exceptions=True)
        for way in done:
            way.result()
    await close(page, NORMAL)


async def _to_viser(page: WebSocket, inner: ClientConnection) -> None:
    """What a browser sends; it may not send faster than a hand can turn the view."""
    with contextlib.suppress(WebSocketDisconnect, ConnectionClosed):
        while True:
            message = await page.receive_bytes()
            if len(message) > MAX_MESSAGE:
                return
            if SHARE not in message:
                await inner.send(message)
            await asyncio.sleep(1.0 / MAX_MESSAGES_PER_S)


async def _to_browser(inner: ClientConnection, page: WebSocket) -> None:
    """What viser sends. A browser that does not read is sent nothing more: viser drops what is outdated."""
    with contextlib.suppress(WebSocketDisconnect, ConnectionClosed, RuntimeError):
        async for message in inner:
            await page.send_bytes(message if isinstance(message, bytes) else message.encode())
