"""From settings to what the supervisor starts: the task table, records, sockets."""

import errno
import os
import socket
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import msgspec

from app.launch.resource_owners import port_holder
from app.supervisor.plan import LOG, OUTPUT, ChildPlan, ServicePlan, log_sockets
from app.web import PROCESS as WEB_PROCESS
from vision_core import startup
from vision_core.clock import Instant
from vision_core.errors import ServiceError
from vision_core.native.kernel_folder import DAMAGED, VARIABLE, choose_kernel_folder, delete_damaged
from vision_core.net.control_files import PREFIX
from vision_core.net.udp import TAKEN, open_server_sockets
from vision_core.rtdb import records
from vision_core.rtdb.infos import ServiceInfo
from vision_core.rtdb.task import DRIVER, MAX_RUN_S, ORDINARY_MAX_RUN_S, Task
from vision_core.settings.layers import Layer
from vision_core.settings.schema import Settings
from vision_core.tasks.table import COMPILER, LOG_READER, RESPONDER, record_specs, task_table

SPARES = ("spare-1", "spare-2")
"""Names of the warm spares; names of tasks have no dash."""
HEARTBEAT_S = 0.3
"""A heartbeat that is older is overdue: a process writes ten a second."""
BLOCKED_DRIVER_S = 6.0
"""Added for a camera: its driver may block for this long when the camera is gone."""
OWN_LOOP_S = 0.8
"""Added for a process with a loop of its own, which writes fewer heartbeats."""
SHORT_RUN_S = 1.0
"""Every real-time task may compute for this long, whatever its period and budget are."""
BACKLOG = 16
ROOM_FOR_ADDRESSES = 1024
"""Left in the service's record beside the settings [bytes]."""


def plan_service(
    settings: Settings, version: str, layers: Sequence[Layer], document: Path, venue: str
) -> tuple[ServicePlan, ServiceInfo]:
    """Open the sockets and lay out everything else. layers: where the settings come from.

    document: the file of what is changed on the page; venue: whose settings these are.

    Raises ServiceError, with nothing left open.
    """
    if sys.platform != "linux":
        raise ServiceError("a PSLV server", found=sys.platform, accepted="Linux (the client runs anywhere)")
    values = tuple(replace(layer, text="") for layer in layers)
    size, room = len(msgspec.msgpack.encode((settings, values))), records.SERVICE.spec.capacity - ROOM_FOR_ADDRESSES
    if size > room:
        raise ServiceError("settings", found=f"{size} bytes of them", accepted=f"at most {room} bytes")
    server = settings.server
    udp_host = server.udp_host or server.host
    http = _listen(server.host, server.port)
    try:
        main, session = open_server_sockets(udp_host, server.udp_port, server.session_port)
    except ServiceError as error:
        http.close()
        raise _with_holder(error, server.udp_port, server.session_port or server.udp_port + 1) from None
    tasks = task_table(settings)
    children = (_log_reader(), _compiler(), _responder(), *_child_plans(tasks, settings))
    with_heartbeat = (*(child.name for child in children), *SPARES)
    boot = time.monotonic_ns()
    info = ServiceInfo(
        version=version,
        boot=Instant(boot),
        http=f"http://{_shown(http)}",
        udp=f"{_shown(main)}, sessions {session.getsockname()[1]}",
        settings=settings,
        tasks=tasks,
        layers=values,
        database=str(document),
        venue=venue,
    )
    log, output = log_sockets()
    plan = ServicePlan(
        children=children,
        records=record_specs(settings, tasks, with_heartbeat),
        initial={"service": records.SERVICE.encode(info)},
        sockets={"http": http, "main": main, "session": session, LOG: log, OUTPUT: output},
        boot=boot,
        spares=SPARES,
        control=f"{PREFIX}{http.getsockname()[1]}",
        spare_module=startup.SPARE,
    )
    return plan, info


def prepare_kernel_folder() -> tuple[str, ...]:
    """Choose the folder of compiled kernels for all processes, and delete what is damaged there; lines for the log.

    Nothing else of the service is kept in the data folder, so one that cannot be used does not prevent the start.
    Raises ServiceError when there is no other folder either: every process would compile for itself, for minutes.
    """
    folder, notice = choose_kernel_folder()
    if folder is None:
        raise ServiceError(
            "a folder for compiled kernels", found=notice, accepted="PSLV_DATA_DIR names one that is ours"
        )
    if notice:
        os.environ[VARIABLE] = str(folder.path.parents[1])
    damaged = DAMAGED.format(folder.path) if delete_damaged(folder) else ""
    folder.close()
    return tuple(line for line in (notice, damaged) if line)


def _compiler() -> ChildPlan:
    """The process that compiles the kernels, before everything that needs them."""
    return ChildPlan(
        name=COMPILER,
        module=startup.COMPILE,
        wakes=(),
        writes=(),
        sockets=(),
        after_compile=False,
        once=True,
        heartbeat_s=MAX_RUN_S,
        longest_run_s=MAX_RUN_S,
        spared=False,
    )


def _responder() -> ChildPlan:
    """Runs from the start; while the task serve does not run, it tells clients that the server is not ready."""
    return ChildPlan(
        name=RESPONDER,
        module=startup.RESPONDER,
        wakes=(),
        writes=(),
        sockets=("main", "session"),
        after_compile=False,
        once=False,
        heartbeat_s=HEARTBEAT_S + OWN_LOOP_S,
        longest_run_s=ORDINARY_MAX_RUN_S,
        spared=False,
        purpose="answers clients while the server is not ready",
    )


def _log_reader() -> ChildPlan:
    """Prints what the others print: they wait for nobody who reads the service's output."""
    return ChildPlan(
        name=LOG_READER,
        module=startup.LOG_READER,
        wakes=(),
        writes=("log",),
        sockets=(LOG,),
        after_compile=False,
        once=False,
        heartbeat_s=HEARTBEAT_S + OWN_LOOP_S,
        longest_run_s=ORDINARY_MAX_RUN_S,
        spared=False,
        purpose="prints what the others print",
    )


def _child_plans(tasks: Sequence[Task], settings: Settings) -> Iterator[ChildPlan]:
    """Every process that the table names, in the table's order."""
    for process in dict.fromkeys(task.process for task in tasks):
        ours = [task for task in tasks if task.process == process]
        own_loop = ours[0].own_loop
        yield ChildPlan(
            name=process,
            module=WEB_PROCESS if own_loop else startup.PROCESS,
            wakes=() if own_loop else tuple(sorted({record for task in ours for record in _wakes(task, tasks)})),
            writes=tuple(record for task in ours for record in task.writes),
            sockets=tuple(name for task in ours for name in task.sockets),
            after_compile=any(task.needs_kernels for task in ours),
            once=False,
            heartbeat_s=HEARTBEAT_S + max(_slack_s(task, settings) for task in ours),
            longest_run_s=_longest_run_s(ours),
            purpose=", ".join(task.purpose for task in ours if task.purpose),
            real_time=any(task.times.priority for task in ours),
        )


def _wakes(task: Task, tasks: Sequence[Task]) -> tuple[str, ...]:
    """Records whose writing releases a task; a driver's task waits for whatever other tasks write for it.

    Every process reads ``live_settings`` in its own time: that record releases none.
    """
    written = {record for other in tasks if other != task for record in other.writes}
    if task.trigger == DRIVER:
        return tuple(record for record in task.reads if record in written and record != records.LIVE_SETTINGS.name)
    return (task.trigger,) if task.trigger in written else ()


def _longest_run_s(tasks: Sequence[Task]) -> float:
    """How much processor time a process may use between two heartbeats before it is taken for hung [s].

    An ordinary process that computes for long delays nothing, so its limit is generous.
    """
    if not any(task.times.priority for task in tasks):
        return ORDINARY_MAX_RUN_S
    return min(max(SHORT_RUN_S, *(max(task.times.period_s, task.times.budget_s) for task in tasks)), MAX_RUN_S)


def _slack_s(task: Task, settings: Settings) -> float:
    """How much longer than HEARTBEAT_S a healthy process may take between two heartbeats because of a task [s]."""
    if task.own_loop:
        return OWN_LOOP_S
    if task.trigger == DRIVER and settings.source.device is not None:
        return BLOCKED_DRIVER_S
    return 0.0


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
        holder = port_holder("tcp", port) if in_use else None
        found = getattr(error, "strerror", None) or str(error)
        raise ServiceError(
            f"TCP port {port} at {host}",
            found=f"{found}, by {holder}" if holder else found,
            accepted=free if in_use else "an address of this machine, and a port that it may open",
        ) from None
    return listener


def _with_holder(error: ServiceError, *ports: int) -> ServiceError:
    """The same, with the process that has one of the UDP ports, if we may know it."""
    if error.found != TAKEN:
        return error
    holder = next((named for port in ports if port and (named := port_holder("udp", port))), None)
    return (
        error
        if holder is None
        else ServiceError(error.asked, found=f"{error.found}, by {holder}", accepted=error.accepted)
    )


def _shown(bound: socket.socket) -> str:
    host, port = bound.getsockname()[:2]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
