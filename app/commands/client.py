"""``pslv client``: the client of ``vision_core.client`` under the command line's roof."""

import sys

import typer

CONTEXT = {"allow_extra_args": True, "ignore_unknown_options": True}
"""Settings of the command: all arguments go to the client's own parser."""


def client(context: typer.Context) -> None:
    """Be a robot: connect, and print what it sees (`pslv client --help`)."""
    from vision_core.client.__main__ import main

    sys.exit(main(context.args))
