"""``pslv restart``: restart a running service, or start one of its processes again that was disabled."""

import time
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.progress import Progress
from app.commands.running import only_service
from vision_core.errors import ServiceError

if TYPE_CHECKING:
    from vision_core.net.control import Attached

POLL_S = 0.1
PATIENCE_S = 30.0
"""For the service to be back."""


def restart(
    process: Annotated[
        str | None, typer.Argument(help="A disabled process, as the page names it. Without: the whole service.")
    ] = None,
    service: Annotated[str | None, typer.Option(help="Name of the service when several run: pslv/8000.")] = None,
) -> None:
    """Restart a service: it reads its files again and keeps its clients. With a name, start that process again."""
    from vision_core.net import control

    name = service or only_service("pslv restart")
    if process is not None:
        control.restart(name, process)
        typer.echo(f"{process} is started again")
        return
    before = control.attach_to(name)
    control.restart_service(name)
    progress = Progress("restarting")
    try:
        _wait_for_end(before, progress)
        progress.show("the new processes begin")
        _wait_for_return(name, before)
    finally:
        progress.show("")
        before.close()
    typer.echo(f"{name} is restarted; its clients stay connected")


def _wait_for_end(before: "Attached", progress: Progress) -> None:
    """Wait until the present processes are stopped. Raises ServiceError when the request is refused."""
    from vision_core.clock import MonotonicClock
    from vision_core.rtdb import records
    from vision_core.rtdb.process_state import RestartState

    clock, reader, shown = MonotonicClock(), records.PROCESSES.reader(before.store), ""
    while (reading := reader.read(clock.now())) is not None and reading.valid:
        restart = reading.value.restart
        if restart.state is RestartState.REFUSED:
            raise ServiceError("pslv restart", found=restart.detail, accepted="the service goes on as it was")
        if restart.detail != shown:
            progress.show(shown := restart.detail)
        time.sleep(POLL_S)


def _wait_for_return(name: str, before: "Attached") -> None:
    """Wait until the restarted service answers. Raises ServiceError."""
    from vision_core.clock import Instant
    from vision_core.net import control
    from vision_core.rtdb import records

    restarts = records.SERVICE.reader(before.store).value(Instant(0)).restarts
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        time.sleep(POLL_S)
        try:
            now = control.attach_to(name)
        except ServiceError:
            continue
        is_back = records.SERVICE.reader(now.store).value(Instant(0)).restarts > restarts
        now.close()
        if is_back:
            return
    raise ServiceError("pslv restart", found=f"no answer of {name} for {PATIENCE_S:g} s", accepted="see its log")
