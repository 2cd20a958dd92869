"""``pslv passwd`` and ``pslv token``: secrets of a service, for the user who runs it; also while it runs."""

import contextlib
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from app.web.auth.people import People

COMMAND_LINE, THIS_MACHINE = "command line", "this machine"
Database = Annotated[
    Path | None, typer.Option(envvar="PSLV_DATABASE", help="Folder of the database; without it, the data folder.")
]


def passwd(
    database: Database = None,
    viewer: Annotated[bool, typer.Option("--viewer", help="The viewers' password instead of the operator's.")] = False,
) -> None:
    """Set the operator's password or PIN; at a terminal it is asked for twice, else one line is read."""
    from app.web.auth.audit import Kind
    from app.web.auth.identity import Role
    from app.web.auth.people import PASSWORD_RULE

    role = Role.VIEWER if viewer else Role.OPERATOR
    if sys.stdin.isatty():
        typer.echo(PASSWORD_RULE)
        password = typer.prompt(f"New password of the {role.value}", hide_input=True, confirmation_prompt=True)
    else:
        password = sys.stdin.readline().rstrip("\n")
    with _people(database) as people:
        people.set_password(role, password)
        people.audit.note(Kind.SECRET, COMMAND_LINE, THIS_MACHINE, f"set the password of the {role.value}")
    typer.echo(f"the password of the {role.value} is set; whoever was logged in as {role.value} has to log in again")


def token(
    name: Annotated[str | None, typer.Argument(help="Makes a token of this name, for a script.")] = None,
    database: Database = None,
    list_: Annotated[bool, typer.Option("--list", help="List the tokens.")] = False,
    revoke: Annotated[int | None, typer.Option(help="Make the token of this number worthless.")] = None,
) -> None:
    """Make, list or revoke tokens, with which scripts may do what the operator may."""
    from app.web.auth.audit import Kind
    from vision_core.errors import PslvError

    with _people(database) as people:
        if revoke is not None:
            gone = people.revoke_token(revoke)
            if gone is None:
                numbers = ", ".join(str(each.id) for each in people.tokens()) or "none: there is no token"
                raise PslvError("a token to revoke", found=str(revoke), accepted=numbers)
            people.audit.note(Kind.SECRET, COMMAND_LINE, THIS_MACHINE, f"revoke token {gone.name}")
            typer.echo(f"token {gone.id} ({gone.name}) is worthless now")
        elif name is not None:
            made, secret = people.new_token(name)
            people.audit.note(Kind.SECRET, COMMAND_LINE, THIS_MACHINE, f"make token {made.name}")
            typer.echo(secret)
            typer.echo("it is shown only now; a script sends the header  Authorization: Bearer TOKEN", err=True)
        elif list_:
            for each in people.tokens():
                used = time.strftime("%Y-%m-%d %H:%M", time.localtime(each.used_at)) if each.used_at else "never"
                typer.echo(f"{each.id}  {each.name}  last used: {used}")
        else:
            raise PslvError("pslv token", found="nothing to do", accepted="a NAME, --list or --revoke NUMBER")


@contextlib.contextmanager
def _people(database: Path | None) -> "Iterator[People]":
    from app.launch.kept_changes import database_folder
    from app.web.auth.people import People
    from app.web.auth.people_file import NAME

    folder, notice = database_folder(database)
    if notice:
        typer.echo(notice, err=True)
    people = People(folder / NAME)
    if people.notice:
        typer.echo(people.notice, err=True)
    try:
        yield people
    finally:
        people.close()
