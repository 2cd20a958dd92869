"""Where a server is."""

import socket

from vision_core.client.lag import SockAddress
from vision_core.errors import ConnectionRefused


def address_of(host: str, port: int) -> tuple[int, SockAddress]:
    """The family and address of a host, IPv4 first. Raises OSError or UnicodeError when there is none."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
    family, _, _, _, address = min(found, key=lambda info: info[0] != socket.AF_INET)
    return family, address


def resolved(name: str, host: str, port: int) -> tuple[int, SockAddress]:
    """The same for a connection of this name. Raises ConnectionRefused."""
    if not 0 < port < 65536:
        raise ConnectionRefused(name, found=f"port {port}", accepted="a port of 1..65535")
    try:
        return address_of(host, port)
    except (socket.gaierror, UnicodeError) as error:
        raise ConnectionRefused(name, found=str(error), accepted="a host name or address, and a port") from None
