"""The web application: reads the database, serves the page, the API and the live connection.

Theory of operation. One process, one event loop, one worker. It shares no interpreter with a real-time task, it reads
shared memory without locks, and no writer ever waits for it. Expensive work (JPEG) runs in a thread, and only while a
page is open.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from fastapi import FastAPI, WebSocket

from app.web.auth.people import People
from app.web.auth.people_file import people_path
from app.web.blackboard import Blackboard
from app.web.configuration.configuration import Configuration
from app.web.configuration.housekeeping import keep_house
from app.web.configuration.task_changes import TaskChanges
from app.web.connections import OperatorAddresses
from app.web.fairness.keeper import FairnessKeeper
from app.web.fairness.kept import KeptReports
from app.web.health.log import watch_health
from app.web.health.monitor import HealthMonitor
from app.web.heartbeat import keep_beating, own_line
from app.web.live.connection import Live
from app.web.live.messages import LiveMessages
from app.web.live.overlays import Overlays
from app.web.middleware.gate import Gate
from app.web.middleware.head import HeadLikeGet
from app.web.middleware.security_headers import SecurityHeaders
from app.web.middleware.under_way import RequestsUnderWay
from app.web.problems import install_problems
from app.web.routes.api import api_routes
from app.web.routes.calibration import calibration_routes
from app.web.routes.clients import client_routes
from app.web.routes.fairness import fairness_routes
from app.web.routes.game import game_routes
from app.web.routes.health import health_routes
from app.web.routes.login import login_routes
from app.web.routes.match import match_routes
from app.web.routes.mirrors import mirror_routes
from app.web.routes.monitors import monitor_routes
from app.web.routes.new_venue import new_venue_routes
from app.web.routes.pages import lost_page, page_routes, static_files
from app.web.routes.people import people_routes
from app.web.routes.restart import restart_routes
from app.web.routes.settings import settings_routes
from app.web.routes.support import support_routes
from app.web.routes.tasks import task_routes
from app.web.routes.teams import team_routes
from app.web.routes.timing import timing_routes
from app.web.routes.view3d import view3d_routes
from app.web.storage.document import Document
from app.web.view3d.view import View3D
from vision_core.rtdb.store import Store
from vision_core.scheduling.metrics import TaskMetrics

DESCRIPTION = """What every robot on the field would see, from one ceiling camera.

Robots use UDP; this API is for people and tools. Everybody may read; changes need the operator.

The page uses the WebSocket `/live?topics=status,world`: each message that a client sends is answered by the newest
messages of these topics, then by `{"topic": "end"}`. Topics: status, world, views, picture, sightings, timing,
overlay/LAYER, log (for the operator), and view/blue/3 for one robot; docs/live.md describes them."""


def create_app(store: Store) -> FastAPI:
    """The application for one database. Raises LookupError when the supervisor has not written its first record."""
    blackboard = Blackboard(store)
    service = blackboard.service
    people = People(people_path(service))
    configuration = Configuration(
        store, service, Document(Path(service.database)), key_digest=people.team_keys.digest_of
    )
    task = own_line(service.tasks)
    metrics = TaskMetrics(store, task, task.process)
    monitor = HealthMonitor()
    overlays = Overlays(store, blackboard.camera.name)
    messages = LiveMessages(blackboard, monitor, configuration, overlays)
    live = Live(blackboard, messages, configuration, metrics)
    view3d = View3D(blackboard, configuration)
    kept = KeptReports(Path(service.database))
    fairness_keeper = FairnessKeeper(blackboard, kept)

    @asynccontextmanager
    async def lifespan(_app: FastAPI) -> AsyncIterator[None]:
        async with asyncio.TaskGroup() as group:  # a bug in one ends both, and the supervisor misses the heartbeat
            background = (
                group.create_task(keep_beating(store, task, metrics, live)),
                group.create_task(watch_health(blackboard, monitor)),
                group.create_task(live.run()),
                group.create_task(view3d.run()),
                group.create_task(keep_house(configuration)),
                group.create_task(fairness_keeper.run()),
            )
            yield
            for each in background:
                each.cancel()
        fairness_keeper.keep_running()
        configuration.document.close()
        people.close()

    app = FastAPI(
        title="PSLV",
        version=service.version,
        description=DESCRIPTION,
        lifespan=lifespan,
        docs_url=None,  # FastAPI's page loads scripts from the internet; ours does not
        redoc_url=None,
    )
    app.state.operators = operators = OperatorAddresses()
    app.add_middleware(RequestsUnderWay)
    app.add_middleware(
        Gate,
        people=people,
        hosts=service.settings.server.hosts,
        viewers=service.settings.server.viewers,
        operators=operators,
    )
    app.add_middleware(HeadLikeGet)
    app.add_middleware(SecurityHeaders)
    install_problems(app, lost_page)
    app.include_router(health_routes(blackboard, monitor))
    app.include_router(api_routes(blackboard, monitor, configuration))
    app.include_router(task_routes(blackboard, TaskChanges(configuration, service)))
    app.include_router(settings_routes(configuration, service))
    app.include_router(calibration_routes(blackboard, configuration))
    app.include_router(new_venue_routes(blackboard, configuration))
    app.include_router(restart_routes(store, blackboard))
    app.include_router(team_routes(configuration, people.team_keys))
    app.include_router(monitor_routes(blackboard, configuration, people.team_keys))
    app.include_router(match_routes(configuration))
    app.include_router(fairness_routes(blackboard, configuration, kept))
    app.include_router(game_routes(blackboard, configuration))
    app.include_router(mirror_routes(configuration))
    app.include_router(login_routes(people, configuration))
    app.include_router(people_routes(people))
    app.include_router(client_routes(blackboard, configuration))
    app.include_router(timing_routes(blackboard, monitor, live))
    app.include_router(support_routes(blackboard, monitor, configuration))
    app.include_router(page_routes())
    app.include_router(view3d_routes(view3d))
    app.mount("/web", static_files())

    @app.websocket("/live")
    async def live_connection(page: WebSocket) -> None:
        await live.watch(page)

    return app
