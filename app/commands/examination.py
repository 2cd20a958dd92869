"""``pslv check``, ``conformance`` and ``check-client``: the commands of ``vision_core.examination`` under this roof."""

import sys

import typer


def check(context: typer.Context) -> None:
    """Before a match: does this computer get its robot's views, how many, how late? (`pslv check --help`)"""
    _examine("check", context)


def conformance(context: typer.Context) -> None:
    """Hold another server to docs/protocol.md, rule by rule, from the wire only (`pslv conformance --help`)."""
    _examine("conformance", context)


def check_client(context: typer.Context) -> None:
    """Play a bad evening to a client and say what it does wrong (`pslv check-client --help`)."""
    _examine("check-client", context)


def _examine(command: str, context: typer.Context) -> None:
    from vision_core.examination.__main__ import main

    sys.exit(main([command, *context.args]))
