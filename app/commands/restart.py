"""``pslv restart``: start a disabled process of a running service again."""

from typing import Annotated

import typer

from app.commands.running import only_service


def restart(
    process: Annotated[str, typer.Argument(help="Name of the process, as /api/v1/status and the page show it.")],
    service: Annotated[str | None, typer.Option(help="Name of the service when several run: pslv/8000.")] = None,
) -> None:
    """Start a process again that was disabled because it crashed too often."""
    from vision_core.net import control

    control.restart(service or only_service("pslv restart"), process)
    typer.echo(f"{process} is started again")
