"""What the client has sent, and whether it is still there."""

from vision_core.clock import Instant
from vision_core.examination.trial.server import Heard, TrialServer
from vision_core.protocol.commands import SERVER_WORDS, decode_commands
from vision_core.protocol.messages import Bye, Command, Init

SHOWN = 60
"""Longest part of a datagram that is shown [characters]."""


def commands_of(heard: Heard) -> tuple[Command, ...]:
    """The commands of a datagram; none if it is no command at all."""
    request = decode_commands(heard.data)
    return request.commands if request else ()


def inits_of(heard: list[Heard]) -> list[Heard]:
    """Those that ask for a robot."""
    return [one for one in heard if any(isinstance(command, Init) for command in commands_of(one))]


def shown(data: bytes) -> str:
    """A datagram for people."""
    text = data.decode("latin-1").encode("unicode_escape").decode("ascii")
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


def left(server: TrialServer, start: Instant) -> str:
    """How the client went away since an instant; empty: it did not."""
    if server.program.status is not None:
        return f"its program ended (exit status {server.program.status})"
    if server.is_gone:
        return "its port is closed"
    if any(isinstance(command, Bye) for one in server.since(start) for command in commands_of(one)):
        return "it said bye"
    return ""


def is_of_a_server(data: bytes) -> bool:
    """Does it begin as only a message of a server may?"""
    head = data.strip().lstrip(b"(").split(b" ")[0].rstrip(b")\0")
    return head.lower() in SERVER_WORDS
