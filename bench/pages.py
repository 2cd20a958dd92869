"""Readers of the page's live connection in one process: each says "next", as web/live.js does, and reads what comes.

    python -m bench.pages HTTP        a line on standard input is how many pages are open from now on

Ends with standard input. Prints JSON: {"messages", "bytes", "most" (pages open at once), "troubles": closed by the
service, with its reason}.
"""

import asyncio
import json
import sys
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from bench.helpers import READY

NEXT = "next"
LAST = "state"
"""Topic that ends a turn."""
LONGEST = 1 << 24
"""Of a message: a picture [bytes]."""


class Pages:
    """All of them."""

    def __init__(self, http: str) -> None:
        self._address = f"{http.replace('http', 'ws', 1)}/live?topics=picture,timing,state"
        self._open: list[asyncio.Task[None]] = []
        self.tally: dict[str, Any] = {"messages": 0, "bytes": 0, "most": 0, "troubles": []}

    async def have(self, count: int) -> None:
        """Open or close pages until there are so many."""
        while len(self._open) < count:
            self._open.append(asyncio.create_task(self._watch()))
        while len(self._open) > count:
            task = self._open.pop()
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        self.tally["most"] = max(self.tally["most"], count)

    async def _watch(self) -> None:
        """One page: asks for the next turn when the last message of one has come."""
        try:
            async with connect(self._address, max_size=LONGEST) as page:
                await page.send(NEXT)
                await self._read(page)
        except (ConnectionClosed, OSError) as trouble:
            self.tally["troubles"].append(repr(trouble))

    async def _read(self, page: ClientConnection) -> None:
        async for message in page:
            self.tally["messages"] += 1
            self.tally["bytes"] += len(message)
            if isinstance(message, str) and json.loads(message)["topic"] == LAST:
                await page.send(NEXT)


async def run(http: str) -> dict[str, Any]:
    """Do as standard input says until it ends."""
    pages, lines = Pages(http), asyncio.StreamReader()
    loop = asyncio.get_running_loop()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(lines), sys.stdin)
    print(READY, flush=True)
    async for line in lines:
        await pages.have(int(line))
    await pages.have(0)
    return pages.tally


if __name__ == "__main__":
    print(json.dumps(asyncio.run(run(sys.argv[1]))))
