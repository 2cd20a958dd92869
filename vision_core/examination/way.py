"""The way to a server, as far as this computer's network tells."""

import contextlib
import socket
from typing import NamedTuple

from vision_core.client.addresses import address_of
from vision_core.protocol.encoding import encode
from vision_core.protocol.messages import Ping

PROBE_S = 0.5
PROBES = 3


class Place(NamedTuple):
    """Where a server is."""

    family: int
    address: tuple[str, int]
    """Host and port."""


def place_of(host: str, port: int) -> Place:
    """The place of a host by name or address, IPv4 first. Raises OSError or UnicodeError when there is none."""
    family, address = address_of(host, port)
    return Place(family, (str(address[0]), int(address[1])))


def own_address(place: Place) -> str:
    """This computer's address on the way there."""
    with contextlib.suppress(OSError), socket.socket(place.family, socket.SOCK_DGRAM) as probe:
        probe.connect(place.address)
        return str(probe.getsockname()[0])
    return "an unknown address"


def why_silent(place: Place) -> str:
    """Why nothing answers there."""
    host, port = place.address
    with socket.socket(place.family, socket.SOCK_DGRAM) as probe:
        probe.settimeout(PROBE_S)
        try:
            probe.connect(place.address)
            for _ in range(PROBES):
                probe.send(encode(Ping()))
                with contextlib.suppress(TimeoutError):
                    probe.recv(2048)
                    break
        except ConnectionRefusedError:
            said = f"{host} says that nobody listens at UDP port {port}"
            return f"{said}: the server does not run, or listens at another address (its server.udp_host)"
        except OSError as error:
            return f"no way leads to {host}: {error.strerror}"
    question = "does the server run there, and listen at this address (its server.udp_host)? Does a firewall drop UDP?"
    return f"nothing answers at {host} port {port}: {question}"
