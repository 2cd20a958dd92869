"""Helper process: web pages that watch a service over its live connection, all in one process.

    python -m bench.pages HTTP TOKEN        each line of standard input is the number of open pages from now on

Each is a dashboard of the operator: status, field at 30 Hz, one robot's view, picture at 15 Hz. A page sends "next" at
the end of each update, as web/src/live does. Ends with standard input.
Prints JSON: {"messages", "bytes", "max_open", "errors": why the service closed pages}.
"""

import asyncio
import json
import sys
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from bench.helpers import READY

NEXT = "next"
TOPICS = "status,world,view/blue/1,picture"
END = "end"
"""Topic of the message that ends an update."""
MAX_MESSAGE = 1 << 24
"""Longest message: a picture [bytes]."""


class Pages:
    """All open pages, and what they received together."""

    def __init__(self, http: str, token: str) -> None:
        self._address = f"{http.replace('http', 'ws', 1)}/live?topics={TOPICS}"
        self._headers = {"authorization": f"Bearer {token}"}
        self._open: list[asyncio.Task[None]] = []
        self.report: dict[str, Any] = {"messages": 0, "bytes": 0, "max_open": 0, "errors": []}

    async def set_count(self, count: int) -> None:
        """Open or close pages until a number of them is open."""
        while len(self._open) < count:
            self._open.append(asyncio.create_task(self._watch()))
        while len(self._open) > count:
            task = self._open.pop()
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        self.report["max_open"] = max(self.report["max_open"], count)

    async def _watch(self) -> None:
        """One page, until it is cancelled or the service closes it."""
        try:
            async with connect(self._address, additional_headers=self._headers, max_size=MAX_MESSAGE) as page:
                await page.send(NEXT)
                await self._read(page)
        except (ConnectionClosed, OSError) as error:
            self.report["errors"].append(repr(error))

    async def _read(self, page: ClientConnection) -> None:
        async for message in page:
            self.report["messages"] += 1
            self.report["bytes"] += len(message)
            if isinstance(message, str) and json.loads(message)["topic"] == END:
                await page.send(NEXT)


async def run(http: str, token: str) -> dict[str, Any]:
    """Open as many pages as standard input asks for, until it ends. Returns the report."""
    pages, lines = Pages(http, token), asyncio.StreamReader()
    loop = asyncio.get_running_loop()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(lines), sys.stdin)
    print(READY, flush=True)
    async for line in lines:
        await pages.set_count(int(line))
    await pages.set_count(0)
    return pages.report


if __name__ == "__main__":
    print(json.dumps(asyncio.run(run(*sys.argv[1:3]))))
