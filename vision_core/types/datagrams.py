"""What became of the datagrams that clients and strangers sent."""

from dataclasses import dataclass


@dataclass(slots=True)
class DatagramCounts:
    """Datagrams since the start of the process that serves."""

    received: int = 0
    ignored: int = 0
    """Too long, without a command, or a message of a server."""
    limited: int = 0
    """Over a rate limit, and dropped unread."""
    turned_away: int = 0
    """From addresses that are not admitted."""
    dropped_by_kernel: int = 0
    """Never received: they could not be a command, or came while the buffer was full."""
