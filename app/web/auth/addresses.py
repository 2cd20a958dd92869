"""The address of a client and the name by which it asked for us, each read in one place."""

import socket
from collections.abc import Iterable
from functools import cache
from ipaddress import IPv6Address, ip_address, ip_network

from starlette.types import Scope

IPV6_SHARE = 64
"""Bits of an address that are common to what one machine may give itself."""


def address_of(scope: Scope) -> str:
    """The client's address; an IPv4 address inside an IPv6 one is told as what it is."""
    client = scope.get("client")
    return plain_address(str(client[0])) if client else "unknown"


def plain_address(host: str) -> str:
    """An address; what is none stays as it is."""
    try:
        address = ip_address(host)
    except ValueError:
        return host
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return str(mapped or address)


def share_of(host: str) -> str:
    """Whose share of something limited an address takes: its own, or that of its IPv6 network."""
    plain = plain_address(host).partition("%")[0]
    try:
        return str(ip_network(f"{plain}/{IPV6_SHARE}", strict=False)) if ":" in plain else plain
    except ValueError:
        return plain


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
