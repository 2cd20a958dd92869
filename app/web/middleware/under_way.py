"""A limit on how many requests are answered at a time; more wait, and too many are asked to come again.

A request has its place until its answer begins: who reads slowly holds up nobody. What changes something is let in with
its whole body, so who sends slowly does not either.
"""

import asyncio
from collections import Counter
from http import HTTPStatus

from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.web.auth.addresses import address_of, share_of
from app.web.auth.rules import READING
from app.web.problems import problem_response

AT_ONCE = 16
WAITING = 128
WAITING_PER_ADDRESS = 64
MAX_BYTES = 262144


class RequestsUnderWay:
    """Middleware that limits them; WebSockets have limits of their own."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._places = asyncio.Semaphore(AT_ONCE)
        self._held: Counter[str] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        share = share_of(address_of(scope))
        if self._held.total() >= AT_ONCE + WAITING or self._held[share] >= WAITING_PER_ADDRESS:
            answer = problem_response(Request(scope), HTTPStatus.SERVICE_UNAVAILABLE, "too many requests at a time")
            answer.headers["retry-after"] = "1"
            await answer(scope, receive, send)
            return
        self._held[share] += 1
        try:
            await self._answer(scope, receive if scope["method"] in READING else await _whole(receive), send)
        finally:
            self._held[share] -= 1
            if not self._held[share]:
                del self._held[share]

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        await self._places.acquire()
        held = True

        async def send_and_leave(message: Message) -> None:
            nonlocal held
            if held and message["type"] == "http.response.start":
                held = False
                self._places.release()
            await send(message)

        try:
            await self._app(scope, receive, send_and_leave)
        finally:
            if held:
                self._places.release()


async def _whole(receive: Receive) -> Receive:
    """A request's body, received before it is needed."""
    messages: list[Message] = []
    length = 0
    while True:
        messages.append(await receive())
        length += len(messages[-1].get("body", b""))
        if not messages[-1].get("more_body", False) or length > MAX_BYTES:
            break

    async def again() -> Message:
        return messages.pop(0) if messages else await receive()

    return again
