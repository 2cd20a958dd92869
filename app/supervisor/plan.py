"""What the supervisor is to start."""

import socket
from dataclasses import dataclass

from vision_core.rtdb.layout import RecordSpec


@dataclass(frozen=True, slots=True)
class ChildPlan:
    """One process."""

    name: str
    module: str
    wakes: tuple[str, ...]
    """Records whose writing raises its event."""
    writes: tuple[str, ...]
    sockets: tuple[str, ...]
    after_compile: bool
    """Started when the process that runs once has ended well."""
    once: bool
    heartbeat_s: float
    """When its last beat is older, it is killed if it is stopped or sleeps on,"""
    longest_run_s: float
    """or has computed for so long since then [s of the processor's time]."""
    spared: bool = True
    """A warm spare may take its place."""


@dataclass(frozen=True, slots=True)
class ServicePlan:
    """The whole service."""

    children: tuple[ChildPlan, ...]
    records: tuple[RecordSpec, ...]
    """Among them ``heartbeat/<name>`` of every child and every spare."""
    initial: dict[str, bytes]
    """First values of records that the supervisor writes."""
    sockets: dict[str, socket.socket]
    boot: int
    """Start of the service [ns of CLOCK_MONOTONIC]."""
    spares: tuple[str, ...]
    """Names of the processes that are kept warm."""
    control: str
    """Name of the abstract socket for requests, without the leading NUL: "pslv/8000"."""
    spare_module: str = "vision_core.startup.spare"
    """What a warm spare runs until it is needed; see there for what is asked of it."""
