"""From settings to what the supervisor starts: the task table, records, processes."""

import os
import socket
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import msgspec

from app.launch.prepared import Prepared
from app.launch.sockets import shown_address
from app.supervisor.plan import LOG, OUTPUT, ChildPlan, ServicePlan, log_sockets
from app.web import PROCESS as WEB_PROCESS
from vision_core import startup
from vision_core.clock import Instant
from vision_core.errors import ServiceError
from vision_core.native.kernel_folder import DAMAGED, VARIABLE, choose_kernel_folder, delete_damaged, is_complete
from vision_core.net.control_files import PREFIX
from vision_core.rtdb import records
from vision_core.rtdb.infos import ServiceInfo
from vision_core.rtdb.task import DRIVER, MAX_RUN_S, ORDINARY_MAX_RUN_S, Task
from vision_core.settings.layers import Layer
from vision_core.settings.schema import Settings
from vision_core.tasks.table import COMPILER, COMPILER_OF_OTHERS, LOG_READER, RESPONDER, WEB, record_specs, task_table

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
ROOM_FOR_ADDRESSES = 1024
"""Left in the service's record beside the settings [bytes]."""


def service_info(
    prepared: Prepared, sockets: Mapping[str, socket.socket], *, version: str, boot: Instant, restarts: int
) -> ServiceInfo:
    """What does not change until the service is restarted. Raises ServiceError as ``layers_without_text``.

    sockets: those of ``open_sockets``; boot: start of the service; restarts: since then.
    """
    return ServiceInfo(
        version=version,
        boot=boot,
        http=f"http://{shown_address(sockets['http'])}",
        udp=f"{shown_address(sockets['main'])}, sessions {sockets['session'].getsockname()[1]}",
        settings=prepared.settings,
        tasks=task_table(prepared.settings),
        layers=layers_without_text(prepared),
        database=str(prepared.document),
        venue=prepared.scope,
        restarts=restarts,
    )


def layers_without_text(prepared: Prepared) -> tuple[Layer, ...]:
    """The layers of settings as the record ``service`` holds them. Raises ServiceError when they do not fit."""
    layers = tuple(replace(layer, text="") for layer in prepared.layers)
    size = len(msgspec.msgpack.encode((prepared.settings, layers)))
    room = records.SERVICE.spec.capacity - ROOM_FOR_ADDRESSES
    if size > room:
        raise ServiceError("settings", found=f"{size} bytes of them", accepted=f"at most {room} bytes")
    return layers


def plan_service(
    info: ServiceInfo,
    sockets: Mapping[str, socket.socket],
    known: Mapping[str, bytes] = MappingProxyType({}),
    check: tuple[str, ...] = (),
    *,
    compiles: bool = True,
) -> ServicePlan:
    """Lay out what the supervisor starts. sockets: those of ``open_sockets``; known: further records by name.

    check: command that finds out whether the service would start again. compiles: kernels may be missing.
    """
    compilers = (_compiler(COMPILER), _compiler(COMPILER_OF_OTHERS, after=COMPILER, may_fail=True)) if compiles else ()
    processes = _child_plans(info.tasks, info.settings, compiles=compiles)
    children = (_log_reader(), *compilers, _responder(), *processes)
    with_heartbeat = (*(child.name for child in children), *SPARES)
    log, output = log_sockets()
    return ServicePlan(
        children=children,
        records=record_specs(info.settings, info.tasks, with_heartbeat),
        initial={**known, "service": records.SERVICE.encode(info)},
        sockets={**sockets, LOG: log, OUTPUT: output},
        boot=info.boot,
        spares=SPARES,
        control=f"{PREFIX}{sockets['http'].getsockname()[1]}",
        spare_module=startup.SPARE,
        check=check,
    )


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


def are_compiled(settings: Settings) -> bool:
    """Are all kernels on disk that a start with these settings needs?"""
    folder, _ = choose_kernel_folder()
    if folder is None:
        return False
    is_done = is_complete(folder, settings.source.kind)
    folder.close()
    return is_done


def _compiler(name: str, *, after: str = "", may_fail: bool = False) -> ChildPlan:
    """A process that compiles kernels, before everything that needs them."""
    return ChildPlan(
        name=name,
        module=startup.COMPILE,
        wakes=(),
        writes=(),
        sockets=(),
        after=after,
        once=True,
        heartbeat_s=MAX_RUN_S,
        longest_run_s=MAX_RUN_S,
        may_fail=may_fail,
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
        after="",
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
        after="",
        once=False,
        heartbeat_s=HEARTBEAT_S + OWN_LOOP_S,
        longest_run_s=ORDINARY_MAX_RUN_S,
        spared=False,
        purpose="prints what the others print",
    )


def _child_plans(tasks: Sequence[Task], settings: Settings, *, compiles: bool) -> Iterator[ChildPlan]:
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
            after=_compiler_for(ours) if compiles else _ready_before(ours),
            once=False,
            heartbeat_s=HEARTBEAT_S + max(_slack_s(task, settings) for task in ours),
            longest_run_s=_longest_run_s(ours),
            purpose=", ".join(task.purpose for task in ours if task.purpose),
            real_time=any(task.times.priority for task in ours),
        )


def _compiler_for(tasks: Sequence[Task]) -> str:
    """Name of the process that compiles the kernels of these tasks."""
    if any(task.on_frame_path for task in tasks):
        return COMPILER
    return COMPILER_OF_OTHERS if any(task.needs_kernels for task in tasks) else ""


def _ready_before(tasks: Sequence[Task]) -> str:
    """Name of the process whose first heartbeat these tasks wait for: robots are served and the page answers first."""
    is_needed = any(task.on_frame_path or task.own_loop for task in tasks)
    return "" if is_needed else WEB


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
