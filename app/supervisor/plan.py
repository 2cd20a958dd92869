"""What the supervisor is to start."""

import socket
from dataclasses import dataclass

from vision_core.rtdb.layout import RecordSpec


@dataclass(frozen=True, slots=True)
class ChildPlan:
    """One process."""

    name: str
    module: str
    trigger: str | None
    """Record that releases it."""
    writes: tuple[str, ...]
    sockets: tuple[str, ...]
    after_compile: bool
    """Started when the process that runs once has ended well."""
    once: bool
    heartbeat_s: float
    """Killed when its record is older."""


@dataclass(frozen=True, slots=True)
class ServicePlan:
    """The whole service."""

    children: tuple[ChildPlan, ...]
    records: tuple[RecordSpec, ...]
    initial: dict[str, bytes]
    """First values of records that the supervisor writes."""
    sockets: dict[str, socket.socket]
    boot: int
    """Start of the service [ns of CLOCK_MONOTONIC]."""
