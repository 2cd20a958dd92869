"""docs/protocol-vectors.json holds for our codec, and misses nothing."""

from collections.abc import Iterable

import pytest

from tests.protocol.vectors import Plain, datagram_of, plain_message, plain_request, vectors
from vision_core.protocol.answers import DECODERS
from vision_core.protocol.commands import COMMANDS, MAX_COMMAND, SERVER_WORDS
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import FIXED_BY_MATCH, UNKNOWN_OPTION
from vision_core.protocol.options import EXTRAS, OPTION_PARSERS
from vision_core.protocol.s_expressions import parse_forms

OF_CLIENTS, OF_SERVERS = vectors("client_to_server"), vectors("server_to_client")
MEANINGS = {"commands", "nul", "error", "answer", "message"}


def meaning(vector: Plain) -> Plain:
    return {name: part for name, part in vector.items() if name in MEANINGS}


def named(found: Iterable[Plain]) -> list[str]:
    return [f"{vector['about']}: {vector['datagram'][:40]}" for vector in found]


@pytest.mark.parametrize("vector", OF_CLIENTS, ids=named(OF_CLIENTS))
def test_a_clients_datagram_means_what_the_file_says(vector: Plain) -> None:
    assert plain_request(datagram_of(vector)) == meaning(vector)


@pytest.mark.parametrize("vector", OF_SERVERS, ids=named(OF_SERVERS))
def test_a_servers_datagram_means_what_the_file_says(vector: Plain) -> None:
    assert plain_message(datagram_of(vector)) == meaning(vector)


def test_every_command_and_every_option_has_a_vector() -> None:
    commands = [command for vector in OF_CLIENTS for command in vector.get("commands", ())]
    assert {command["form"] for command in commands} == set(COMMANDS)
    robots = {command["form"] for command in commands if "team" in command}
    assert robots == set(COMMANDS) - {"ping", "sync", "dispinit"}
    assert option_names("commands") >= {*OPTION_PARSERS, "cookie", "key"}
    assert option_names("error") >= {*OPTION_PARSERS, "cookie", "key"}


def option_names(kind: str) -> set[str]:
    """The options of all inits that are taken, or refused."""
    names = set()
    for vector in OF_CLIENTS:
        for form in parse_forms(datagram_of(vector).strip(b"\0")) or () if kind in vector else ():
            names |= {str(part[0]) for part in form[1:] if isinstance(part, tuple) and part}
    return names


def test_every_mistake_that_can_be_read_from_a_datagram_has_a_vector() -> None:
    of_datagrams = {code for code in ErrorCode if code.startswith("illegal")} | {ErrorCode.UNKNOWN_COMMAND}
    of_datagrams -= {ErrorCode.ILLEGAL_DRIVE}  # the robot's limits decide
    assert {vector["error"] for vector in OF_CLIENTS if "error" in vector} == of_datagrams


def test_every_silence_has_a_vector() -> None:
    silent = [datagram_of(vector) for vector in OF_CLIENTS if "answer" in vector]
    heads = {datagram[1:].split(b" ")[0].rstrip(b")") for datagram in silent if datagram.startswith(b"(")}
    assert heads >= SERVER_WORDS | {b"init", b"dispinit", b"mirror", b"sync"}
    assert any(len(datagram) == MAX_COMMAND + 1 for datagram in silent)


def test_every_message_error_warning_and_extra_has_a_vector() -> None:
    messages = [vector["message"] for vector in OF_SERVERS if vector["message"] is not None]
    assert {message["form"] for message in messages} == {*DECODERS, "see"}
    names = {form: {m["name"] for m in messages if m["form"] == form} for form in ("error", "warning")}
    assert names["error"] >= set(ErrorCode)
    assert names["warning"] == {UNKNOWN_OPTION, FIXED_BY_MATCH}
    assert {extra for message in messages for extra in message.get("extras", ())} >= set(EXTRAS)
    assert any("facts" in message for message in messages)


def test_views_are_in_order_of_time() -> None:
    """So a client may be sent them one after the other."""
    times = [vector["message"]["time_us"] for vector in OF_SERVERS if (vector["message"] or {}).get("form") == "see"]
    assert times == sorted(times)
    assert len(set(times)) == len(times)
