"""Answers that cost time are made at most once per period, in a thread, however many ask."""

import asyncio
import time
from collections.abc import Callable


class Cached:
    """The newest answer of one kind."""

    def __init__(self, make: Callable[[], bytes], period_s: float) -> None:
        """make: the answer, in a thread. period_s: an answer that is younger is given again."""
        self._make = make
        self._period_s = period_s
        self._making = asyncio.Lock()
        self._answer = b""
        self._made_s = float("-inf")

    async def get(self) -> bytes:
        """The answer; who asks while it is made waits for it."""
        async with self._making:
            if time.monotonic() - self._made_s >= self._period_s:
                self._answer = await asyncio.to_thread(self._make)
                self._made_s = time.monotonic()
            return self._answer
