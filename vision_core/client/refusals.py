"""Why a connection is not to be had, in words for people."""

from vision_core.errors import ConnectionRefused
from vision_core.protocol.error_codes import MEANINGS

NO_MIRROR = (
    "mirror=Mirror(A, B, C) with the constants of the server's field preset (config/fields/*.toml),"
    " or options=Options(mirror=...) to ask for a mirror of your own"
)


def mirror_unknown(name: str) -> ConnectionRefused:
    """The server tells no mirror. name: of the connection."""
    return ConnectionRefused(name, found="the server does not tell its mirror", accepted=NO_MIRROR)


def no_answer(name: str, address: str, last_error: str, timeout_s: float) -> ConnectionRefused:
    """Nothing came in time, or nothing but an error."""
    if last_error in MEANINGS:
        return ConnectionRefused(
            name,
            found=f"error {last_error} for {timeout_s:g} s: {MEANINGS[last_error]}",
            accepted="an answer to init; a longer timeout",
            code=last_error,
        )
    return ConnectionRefused(
        name,
        found=f"nothing answered at {address} within {timeout_s:g} s",
        accepted="a server that runs there (pslv serve) and that this computer may reach: see server.udp_host and"
        " admission.subnets in its settings, and firewalls in between",
    )
