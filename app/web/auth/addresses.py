"""The address of a client and the name by which it asked for us, each read in one place."""

import socket
from collections.abc import Iterable
from functools import cache
from ipaddress import IPv6Address, ip_address

from starlette.types import Scope


def address_of(scope: Scope) -> str:
    """The client's address; an IPv4 address inside an IPv6 one is told as what it is."""
    client = scope.get("client")
    if client is None:
        return "unknown"
    try:
        address = ip_address(client[0])
    except ValueError:
        return str(client[0])
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return str(mapped or address)


def is_our_name(host: str, further: Iterable[str]) -> bool:
    """May a page be asked for under this name? host: of the header Host, perhaps with a port.

    An IP address cannot be made to point elsewhere. A foreign name can (DNS rebinding), so names are those of this
    machine and those that the settings list.
    """
    name = _without_port(host)
    try:
        return bool(ip_address(name))
    except ValueError:
        return name.lower().rstrip(".") in {*_own_names(), *(each.lower() for each in further)}


def _without_port(host: str) -> str:
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.rpartition(":")[0] if host.count(":") == 1 else host


@cache
def _own_names() -> frozenset[str]:
    name = socket.gethostname().lower()
    return frozenset({"localhost", name, f"{name.partition('.')[0]}.local"})
