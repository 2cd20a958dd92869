"""A service from its first start to its end: restarts of the whole service are turns of one loop.

Sockets, the clock of the protocol and the clients' sessions outlive a restart; everything else is made anew, from the
files and what was changed on the page. The new processes load everything while the old ones go on.
"""

import socket
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass

from app import __version__
from app.launch.first_lines import FirstLines
from app.launch.page import page_being_built
from app.launch.plan import are_compiled, plan_service, service_info
from app.launch.preflight import preflight
from app.launch.prepared import Prepared, StartOptions, prepare
from app.launch.resource_owners import lock_camera
from app.launch.restart_check import Running, check_command
from app.launch.sockets import open_sockets
from app.supervisor.priorities import unhurried
from app.supervisor.supervisor import Supervisor
from vision_core.clock import Instant
from vision_core.errors import PslvError, ServiceError
from vision_core.rtdb import records
from vision_core.rtdb.infos import SelfTest, ServiceInfo
from vision_core.rtdb.log_record import LOG


@dataclass(frozen=True, slots=True)
class Reports:
    """To whom a start reports."""

    lines: FirstLines
    """Takes the lines of a start."""
    log: Callable[[str], None]
    """Takes one line of a running service that cannot print it otherwise."""
    progress: Callable[[str], None] | None
    """Takes the progress of the compiler, "" when it is done; None: it is logged."""
    started: Callable[[ServiceInfo, SelfTest, Callable[[str], None]], None]
    """Is told of the first start before anything runs, and to whom to say it."""


def run_service(start: StartOptions, reports: Reports) -> int:
    """Run a service until it is stopped. Returns its exit status. Raises PslvError when it cannot be started."""
    if sys.platform != "linux":
        raise ServiceError("a PSLV server", found=sys.platform, accepted="Linux (the client runs anywhere)")
    prepared = prepare(start, reports.lines.say)
    with ExitStack() as held:
        camera = held.enter_context(_locked_camera(prepared))
        sockets = {name: held.enter_context(opened) for name, opened in open_sockets(prepared.settings.server).items()}
        boot = Instant(time.monotonic_ns())
        info = service_info(prepared, sockets, version=__version__, boot=boot, restarts=0)
        machine = preflight(prepared.settings, reports.lines.say)
        held.enter_context(page_being_built())  # not before: the self-test of the machine wants it quiet
        reports.started(info, machine, reports.lines.say)
        known = {records.SELF_TEST.name: records.SELF_TEST.encode(machine), LOG.name: reports.lines.record()}
        compiles = not are_compiled(prepared.settings)
        plan = plan_service(info, sockets, known, _check(start, prepared), compiles=compiles)
        first = Supervisor(plan, reports.log, reports.progress)
        first.start()
        service = _Service(start, reports, sockets, camera, prepared, info, first)
        while not service.supervisor.is_stopping:
            service.run()
        service.supervisor.stop()
        service.camera.close()
        return service.supervisor.exit_status


@dataclass(slots=True)
class _Service:
    """A running service."""

    start: StartOptions
    reports: Reports
    sockets: Mapping[str, socket.socket]
    camera: ExitStack
    """Holds the camera, if the source is one."""
    prepared: Prepared
    info: ServiceInfo
    supervisor: Supervisor

    def run(self) -> None:
        """Run until the service is stopped, or until it was restarted once."""
        running = self.supervisor
        running.run(lambda: running.is_restarting)
        if running.is_stopping:
            return
        try:
            with unhurried():
                prepared, info, camera, successor = self._successor()
        except PslvError as error:
            running.refuse_restart(str(error))
            return

        def is_warm() -> bool:
            done, wanted = successor.warm_up()
            running.tell_restart(f"{done} of {wanted} new processes have loaded what they need")
            return done == wanted

        running.run(is_warm)
        if running.is_stopping:
            successor.stop()
            return
        carried = running.stop()
        if camera is not self.camera:
            self.camera.close()
        successor.start(carried)
        self.prepared, self.info, self.camera, self.supervisor = prepared, info, camera, successor

    def _successor(self) -> tuple[Prepared, ServiceInfo, ExitStack, Supervisor]:
        """What the files and the page have now, the camera held for it, and a supervisor for it. Raises PslvError."""
        prepared = prepare(self.start, self.supervisor.say)
        info = service_info(
            prepared, self.sockets, version=__version__, boot=self.info.boot, restarts=self.info.restarts + 1
        )
        is_same = prepared.settings.source.device == self.prepared.settings.source.device
        camera = self.camera if is_same else _locked_camera(prepared)
        plan = plan_service(info, self.sockets, {}, _check(self.start, prepared), compiles=False)
        return prepared, info, camera, Supervisor(plan, self.reports.log, self.reports.progress)


def _check(start: StartOptions, prepared: Prepared) -> tuple[str, ...]:
    """The command that finds out whether a service that was started like this would start again."""
    return check_command(Running(start, prepared.settings.server, prepared.settings.source.uri))


def _locked_camera(prepared: Prepared) -> ExitStack:
    """Holds the camera, if the source is one, until it is closed. Raises ServiceError when another service has it."""
    held = ExitStack()
    if prepared.settings.source.device is not None:
        held.enter_context(lock_camera(prepared.settings.source.device))
    return held
