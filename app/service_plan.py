"""From settings to what the supervisor starts: the task table, records, sockets."""

import errno
import os
import socket
import sys
import time

import msgspec

from app.supervisor.plan import ChildPlan, ServicePlan
from vision_core.clock import Instant
from vision_core.errors import ServiceError
from vision_core.kernel_cache import kernel_folder
from vision_core.net.udp import open_server_sockets
from vision_core.rtdb import records
from vision_core.rtdb.records import ServiceInfo
from vision_core.settings import Settings
from vision_core.tasks.table import Task, record_specs, task_table

HEARTBEAT_S = 4.0
HEARTBEAT_PERIODS = 4.0
BACKLOG = 128
ROOM_FOR_ADDRESSES = 1024
"""In the record of the service, beside the settings [bytes]."""


def plan_service(settings: Settings, version: str) -> tuple[ServicePlan, ServiceInfo]:
    """Open the sockets and lay out everything else. Raises ServiceError, with nothing left open."""
    if sys.platform != "linux":
        raise ServiceError("a PSLV server", found=sys.platform, accepted="Linux (the client runs anywhere)")
    size, room = len(msgspec.msgpack.encode(settings)), records.SERVICE.spec.capacity - ROOM_FOR_ADDRESSES
    if size > room:
        raise ServiceError("settings", found=f"{size} bytes of them", accepted=f"at most {room} bytes")
    server = settings.server
    udp_host = server.udp_host or server.host
    http = _listen(server.host, server.port)
    try:
        main, session = open_server_sockets(udp_host, server.udp_port, server.session_port)
    except ServiceError:
        http.close()
        raise
    tasks = task_table(settings.camera.name)
    boot = time.monotonic_ns()
    info = ServiceInfo(
        version=version,
        boot=Instant(boot),
        http=f"http://{_shown(http)}",
        udp=f"{_shown(main)}, sessions {session.getsockname()[1]}",
        settings=settings,
    )
    plan = ServicePlan(
        children=tuple(_child_plan(task, settings) for task in tasks),
        records=record_specs(settings, tasks),
        initial={"service": records.SERVICE.encode(info)},
        sockets={"http": http, "main": main, "session": session},
        boot=boot,
    )
    return plan, info


def prepare_data_folder() -> None:
    """Make the folder of state, down to the compiled kernels. Raises ServiceError when it cannot be written."""
    folder = kernel_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        writable = os.access(folder, os.W_OK)
    except OSError as error:
        raise ServiceError(f"data folder {folder}", found=str(error), accepted="PSLV_DATA_DIR names another") from None
    if not writable:
        raise ServiceError(
            f"data folder {folder}", found="it cannot be written", accepted="PSLV_DATA_DIR names another"
        )


def _child_plan(task: Task, settings: Settings) -> ChildPlan:
    return ChildPlan(
        name=task.name,
        module=task.module,
        trigger=task.trigger,
        writes=task.writes,
        sockets=task.sockets,
        after_compile=task.needs_kernels,
        once=task.once,
        heartbeat_s=HEARTBEAT_S + HEARTBEAT_PERIODS / settings.camera.rate_hz,
    )


def _listen(host: str, port: int) -> socket.socket:
    """The page's listening socket."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
        listener.listen(BACKLOG)
    except (OSError, TypeError) as error:  # TypeError: what no host can be named, in bind's words
        listener.close()
        in_use = getattr(error, "errno", None) == errno.EADDRINUSE
        free = "a free port: --port 0 takes any, --port N chooses one"
        raise ServiceError(
            f"TCP port {port} at {host}",
            found=getattr(error, "strerror", None) or str(error),
            accepted=free if in_use else "an address of this machine, and a port that it may open",
        ) from None
    return listener


def _shown(bound: socket.socket) -> str:
    host, port = bound.getsockname()[:2]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
