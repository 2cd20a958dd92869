"""The sockets of a service, opened before anything starts. A restart of the service goes on with them."""

import errno
import socket

from app.launch.resource_owners import port_holder
from vision_core.errors import ServiceError
from vision_core.net.udp import TAKEN, open_server_sockets
from vision_core.settings.schema import ServerSettings

BACKLOG = 16
ADDRESSES = ("host", "udp_host", "port", "udp_port", "session_port")
"""Settings of the server that a restart cannot change."""


def open_sockets(server: ServerSettings) -> dict[str, socket.socket]:
    """Open the page's listening socket, "http", and the UDP sockets "main" and "session".

    Raises ServiceError, with nothing left open.
    """
    udp_host = server.udp_host or server.host
    http = _listen(server.host, server.port)
    try:
        main, session = open_server_sockets(udp_host, server.udp_port, server.session_port)
    except ServiceError as error:
        http.close()
        raise _with_holder(error, server.udp_port, server.session_port or server.udp_port + 1) from None
    return {"http": http, "main": main, "session": session}


def _listen(host: str, port: int) -> socket.socket:
    """The page's listening socket."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
        listener.listen(BACKLOG)
    except (OSError, TypeError) as error:  # TypeError: what no host can be named, in bind's words
        listener.close()
        in_use = getattr(error, "errno", None) == errno.EADDRINUSE
        free = "a free port: --port 0 takes any, --port N chooses one"
        holder = port_holder("tcp", port) if in_use else None
        found = getattr(error, "strerror", None) or str(error)
        raise ServiceError(
            f"TCP port {port} at {host}",
            found=f"{found}, by {holder}" if holder else found,
            accepted=free if in_use else "an address of this machine, and a port that it may open",
        ) from None
    return listener


def _with_holder(error: ServiceError, *ports: int) -> ServiceError:
    """The same, with the process that has one of the UDP ports, if we may know it."""
    if error.found != TAKEN:
        return error
    holder = next((named for port in ports if port and (named := port_holder("udp", port))), None)
    return (
        error
        if holder is None
        else ServiceError(error.asked, found=f"{error.found}, by {holder}", accepted=error.accepted)
    )


def shown_address(bound: socket.socket) -> str:
    """Host and port of a bound socket: "127.0.0.1:8000"."""
    host, port = bound.getsockname()[:2]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
