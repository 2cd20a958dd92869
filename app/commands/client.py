"""``pslv client``: the client of ``vision_core.client`` under the command line's roof."""

import sys
from collections.abc import Iterator
from pathlib import Path

import typer

from vision_core.geometry import Bytes

CONTEXT = {"allow_extra_args": True, "ignore_unknown_options": True}
"""Settings of the command: all arguments go to the client's own parser."""


def client(context: typer.Context) -> None:
    """Be a robot: connect, and print what it sees (`pslv client --help`)."""
    from vision_core.client.__main__ import main

    def open_pictures(path: Path) -> Iterator[Bytes]:
        from vision_core.onboard.pictures import open_pictures as open_with_opencv

        return open_with_opencv(path)

    sys.exit(main(context.args, open_pictures))
