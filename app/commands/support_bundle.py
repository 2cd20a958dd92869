"""``pslv support-bundle``: everything that somebody needs who is to help, also when the page does not answer."""

import contextlib
import time
from pathlib import Path
from typing import Annotated

import typer

from app.commands.running import only_service
from vision_core.errors import PslvError

WATCH_S = 7.0
"""The longest that a cause of worse service has to last until it is reported is 6 s."""
EVERY_S = 0.5


def support_bundle(
    file: Annotated[Path | None, typer.Argument(help="The zip; without it, pslv-support-TIME.zip here.")] = None,
    service: Annotated[str | None, typer.Option(help="Name of the service when several run: pslv/8000.")] = None,
) -> None:
    """Pack versions, settings, health, log, timing and a picture of a running service into a zip, without secrets."""
    from app.web.blackboard import Blackboard
    from app.web.health.monitor import HealthMonitor
    from app.web.storage.document import Document
    from app.web.support.bundle import CHANGES, bundle_name, bundle_of, gathered
    from vision_core.net.control import attach_to

    attached = attach_to(service or only_service("pslv support-bundle"))
    blackboard, monitor = Blackboard(attached.store), HealthMonitor()
    typer.echo(f"watching {attached.name} for {WATCH_S:.0f} s", err=True)
    began = time.monotonic()
    health = monitor.judge(blackboard.read())
    while time.monotonic() - began < WATCH_S:
        time.sleep(EVERY_S)
        health = monitor.judge(blackboard.read())
    with contextlib.closing(Document(Path(blackboard.service.database))) as document:
        changes = document.history(CHANGES)
    path = file or Path(bundle_name())
    try:
        path.write_bytes(bundle_of(gathered(blackboard, health, changes)))
    except OSError as error:
        raise PslvError(
            f"file {path}", found=error.strerror or str(error), accepted="one that can be written"
        ) from None
    typer.echo(f"{path}: look into it before you send it; README.txt says what is in it")
