"""The web application: reads the database, serves the page, the API and the live connection.

Theory of operation. One process, one event loop, one worker. It shares no interpreter with anything that
keeps time, reads shared memory without locks, and no writer ever waits for it. What costs (JPEG) runs in
a thread and only while somebody looks.

Files, outside-in: ``web_process`` (entry), this factory, ``routes`` (HTTP), ``live`` (WebSocket),
``reports`` and ``readiness`` (what is told), ``blackboard`` (what is read).
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI, WebSocket

from app.blackboard import Blackboard
from app.heartbeat import beat
from app.live import Live
from app.problems import install_problems
from app.routes.api import api_routes
from app.routes.health import health_routes
from app.routes.pages import page_routes, static_files
from app.security import SecurityHeaders, is_same_origin
from vision_core.rtdb.store import Store

DESCRIPTION = """What every robot on the field would see, from one ceiling camera.

Robots talk UDP; this API is for people and tools, and it only reads. The live connection of the page is the
WebSocket `/live`: send any message, and the newest picture (binary) and state (JSON) come back."""
POLICY_VIOLATION = 1008


def create_app(store: Store) -> FastAPI:
    """The application on a database. Raises LookupError before the supervisor's first record."""
    blackboard = Blackboard(store)
    live = Live(blackboard)

    @asynccontextmanager
    async def lifespan(_app: FastAPI) -> AsyncIterator[None]:
        async with asyncio.TaskGroup() as tasks:  # a bug in one ends both, and the supervisor misses the heartbeat
            background = (tasks.create_task(beat(store, live)), tasks.create_task(live.run()))
            yield
            for task in background:
                task.cancel()

    app = FastAPI(
        title="PSLV",
        version=blackboard.service.version,
        description=DESCRIPTION,
        lifespan=lifespan,
        docs_url=None,  # ours needs no internet
        redoc_url=None,
    )
    app.add_middleware(SecurityHeaders)
    install_problems(app)
    app.include_router(health_routes(blackboard))
    app.include_router(api_routes(blackboard))
    app.include_router(page_routes())
    app.mount("/web", static_files())

    @app.websocket("/live")
    async def live_connection(page: WebSocket) -> None:
        if is_same_origin(page.headers.get("origin"), page.headers.get("host")):
            await live.watch(page)
        else:
            await page.close(POLICY_VIOLATION)

    return app
