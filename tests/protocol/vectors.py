"""docs/protocol-vectors.json, and our records in its words."""

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from vision_core.client.view import View, view_from_see
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.protocol.answers import decode_message
from vision_core.protocol.commands import decode_commands
from vision_core.protocol.messages import (
    Command,
    ErrorReply,
    Hear,
    InitReply,
    InvalidCommand,
    LagReport,
    MirrorQuery,
    MirrorReply,
    MonitorInit,
    MonitorReply,
    See,
    ServerMessage,
    SyncReply,
    WarningReply,
)
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.protocol.proofs import NO_PROOF

FILE = Path(__file__).parents[2] / "docs" / "protocol-vectors.json"
Plain = dict[str, Any]
NAMES = {
    LagReport: "lag",
    MirrorQuery: "mirror",
    InitReply: "init",
    MonitorInit: "dispinit",
    MonitorReply: "dispinit",
    MirrorReply: "mirror",
    SyncReply: "sync",
    ErrorReply: "error",
    WarningReply: "warning",
    Hear: "hear",
}
"""Names on the wire, where they are not those of our records."""


def vectors(side: str) -> list[Plain]:
    found: list[Plain] = json.loads(FILE.read_text(encoding="utf-8"))[side]
    return found


def datagram_of(vector: Plain) -> bytes:
    return str(vector["datagram"]).encode("latin-1")


def plain_request(datagram: bytes) -> Plain:
    """What our server takes a client's datagram for: commands, an error, or nothing, which gets no answer."""
    request = decode_commands(datagram)
    if request is None:
        return {"answer": None}
    for command in request.commands:
        if isinstance(command, InvalidCommand):
            return {"error": str(command.error)}
    ends_with_nul = {"nul": True} if request.nul else {}
    return {"commands": [named(command) for command in request.commands]} | ends_with_nul


def plain_message(datagram: bytes) -> Plain:
    """What our client takes a server's datagram for; nothing: it is passed over."""
    message = decode_message(datagram)
    if message is None:
        return {"message": None}
    told = named(message)
    if isinstance(message, See):
        told |= {"letters": "".join(view_of(message).letters), "px": view_of(message).px.tolist()}
        del told["edges"]
    return {"message": told}


def view_of(see: See) -> View:
    return view_from_see(see, PAPER_OPTIONS, PAPER_MIRROR)


def named(record: Command | ServerMessage) -> Plain:
    """A message by its name on the wire."""
    kind = NAMES.get(type(record), type(record).__name__.lower())
    return {"form": kind} | plain_record(record)


def plain(value: Any) -> Any:
    """A part of a message as JSON types."""
    match value:
        case Mirror():
            return [value.a, value.b, value.c]
        case StrEnum():
            return str(value)
        case tuple():
            return [plain(part) for part in value]
        case bytes():
            return value.decode("ascii")
        case Mapping():
            return {name: plain(part) for name, part in value.items()}
    return plain_record(value) if is_dataclass(value) else value


def plain_record(record: Any) -> Plain:
    """Without what is not said, options that have their default, and words of a proof that did not come."""
    parts = {field.name: getattr(record, field.name) for field in fields(record)}
    if isinstance(record, Options):
        parts = {name: own for name, own in parts.items() if own != getattr(PAPER_OPTIONS, name)}
    proof = parts.pop("proof", NO_PROOF)
    said = {name: plain(part) for name, part in parts.items() if part is not None and part is not False}
    said |= {name: word for name, word in (("cookie", proof.cookie), ("key", proof.key)) if word}
    return {name: part for name, part in said.items() if part != {}}
