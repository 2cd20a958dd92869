"""What the configuration needs from time to time: admissions whose time is over end."""

import asyncio

from app.web.configuration.configuration import Configuration

EVERY_S = 1.0


async def keep_house(configuration: Configuration) -> None:
    """End admissions for as long as the web process runs."""
    while True:
        await asyncio.to_thread(configuration.end_admissions)
        await asyncio.sleep(EVERY_S)
