"""What the kernel's stamp of a sending costs, and how far the stamp is off that the program reads right after send.

Setup: 22 connected sockets on loopback, views of 1120 bytes; a loop in C (``baselines/send_stamps.c``) that reads the
clock after each send, without and with SO_TIMESTAMPING, whose stamps it fetches after each round. Both take turns. At
rest, and while every core is busy.
"""

import contextlib
import ctypes
import socket
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.baselines.build import load_library
from bench.load import full_load
from bench.runner import Row
from vision_core.clock import NS_PER_US

CLIENTS, BLOCKS, ROUNDS = 22, 100, 40


def run(blocks: int = BLOCKS) -> list[Row]:
    """At rest and under load. blocks: of ROUNDS frames each, of either kind."""
    library, message = load_library("send_stamps")
    if library is None:
        return [{"name": f"kernel's stamps ({message})"}]
    library.send_stamped.restype = ctypes.c_int64
    with contextlib.ExitStack() as stack:
        kinds = [_sockets(stack) for _ in range(2)]
        rows = _rows("at rest", library, kinds, blocks)
        with full_load():
            rows += _rows("all cores busy", library, kinds, blocks)
    return rows


def _rows(name: str, library: ctypes.CDLL, kinds: list[list[list[socket.socket]]], blocks: int) -> list[Row]:
    sends: list[list[float]] = [[], []]
    drains: list[list[float]] = [[], []]
    late_all: list[float] = []
    missing = 0
    for _ in range(blocks):
        for kernel, (senders, clients) in enumerate(kinds):
            lost, send_us, drain_us, late_us = _block(library, senders, kernel)
            if lost < 0:
                return [{"name": f"{name}: this system has no stamps of sendings"}]
            missing += lost
            sends[kernel] += send_us.tolist()
            drains[kernel] += drain_us.tolist()
            if kernel:
                late_all += late_us.tolist()
            _drain(clients)
    plain, stamped = (float(np.median(each)) / CLIENTS for each in sends)
    fetching = float(np.median(drains[1])) / CLIENTS
    own, p99, p999 = (float(np.percentile(late_all, share)) for share in (50.0, 99.0, 99.9))
    return [
        {"name": f"{name}: send with the kernel's stamp, per datagram", "value": stamped, "unit": "us",
         "baseline": plain, "ratio": stamped / plain},
        {"name": f"{name}: fetching it, per datagram", "value": fetching, "unit": "us"},
        {"name": f"{name}: the program's stamp is later by (median)", "value": own, "unit": "us"},
        {"name": f"{name}: the same, 99 %", "value": p99, "unit": "us"},
        {"name": f"{name}: the same, 99.9 %", "value": p999, "unit": "us"},
        {"name": f"{name}: stamps that were missing", "value": missing, "unit": ""},
    ]  # fmt: skip


def _block(
    library: ctypes.CDLL, senders: list[socket.socket], kernel: int
) -> tuple[int, NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Lost stamps; times of sending and of fetching of each round, and how late each datagram's own stamp is [us]."""
    descriptors = np.array([each.fileno() for each in senders], dtype=np.int64)
    send_ns, drain_ns = np.zeros(ROUNDS, dtype=np.int64), np.zeros(ROUNDS, dtype=np.int64)
    late_ns = np.zeros(ROUNDS * len(senders), dtype=np.int64)
    addresses = [ctypes.c_void_p(array.ctypes.data) for array in (descriptors, send_ns, drain_ns, late_ns)]
    counts = [ctypes.c_int64(number) for number in (len(senders), ROUNDS, kernel)]
    lost = library.send_stamped(addresses[0], *counts, *addresses[1:])
    return lost, send_ns / NS_PER_US, drain_ns / NS_PER_US, late_ns / NS_PER_US


def _sockets(stack: contextlib.ExitStack) -> list[list[socket.socket]]:
    """Connected senders, and the clients at their other ends."""
    pairs = list(_pairs(stack))
    return [[sender for sender, _ in pairs], [client for _, client in pairs]]


def _pairs(stack: contextlib.ExitStack) -> Iterator[tuple[socket.socket, socket.socket]]:
    for _ in range(CLIENTS):
        client = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        client.bind(("127.0.0.1", 0))
        client.setblocking(False)
        sender = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        sender.connect(client.getsockname())
        yield sender, client


def _drain(clients: list[socket.socket]) -> None:
    for client in clients:
        with contextlib.suppress(BlockingIOError):
            while client.recv(2048):
                pass
