"""Duration of sending one frame's datagrams to 22 and to 200 clients on loopback.

Every client has a socket of its own; the sender has one connected socket for each, as the service has for each session.
Measured [us]: median time of the service's compiled loop over all clients. Baselines in the same process, by turns: the
same loop in C (``baselines/udp_send.c``), goal at most 1.05 of its time, and a loop in Python. The clients' sockets are
emptied between two measurements.
"""

import contextlib
import ctypes
import socket
import time
from collections.abc import Callable

import numpy as np

from bench.baselines.build import load_library
from bench.runner import Row
from vision_core.clock import US_PER_S, Instant
from vision_core.net.delivery import Batch, DeliveryTable
from vision_core.net.delivery_rows import new_rows
from vision_core.net.udp import SharedSocket
from vision_core.types.fairness import MAX_ROBOTS

CLIENTS = (22, 200)
ROUNDS = 400
DATAGRAM = b"(see 20306.148 ((edge) " + b"w2c" * 360 + b") ((ball) 61 121 3))"
GOAL_RATIO = 1.05


def run() -> list[Row]:
    """Measure every number of clients."""
    rows: list[Row] = []
    for count in CLIENTS:
        with contextlib.ExitStack() as stack:
            rows += _measure(count, stack)
    return rows


def _measure(count: int, stack: contextlib.ExitStack) -> list[Row]:
    server = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    server.bind(("127.0.0.1", 0))
    shared = SharedSocket(server)
    clients, sessions = [], []
    for _ in range(count):
        client = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        client.bind(("127.0.0.1", 0))
        client.setblocking(False)
        clients.append(client)
        session = shared.open_session("127.0.0.1", (*client.getsockname(), 0))
        stack.callback(session.close)
        sessions.append(session)
    batch = Batch.of([DATAGRAM] * count)
    table = DeliveryTable(Instant(0), seed=1)
    table.replace(new_rows(count))
    table.rows["descriptor"] = [session.fileno() for session in sessions]
    table.rows["robot"] = np.arange(count) % MAX_ROBOTS
    methods: dict[str, Callable[[], object]] = {"compiled": lambda: table.send(Instant(1), batch)}
    c_loop, message = _c_loop(table, batch)
    if c_loop is not None:
        methods["C"] = c_loop
    methods["Python"] = lambda: [session.send(DATAGRAM) for session in sessions]
    times = _medians_us(list(methods.values()), clients)
    took = dict(zip(methods, times, strict=True))
    ratio = took["compiled"] / took["C"] if "C" in took else None
    name = f"send to {count} clients"
    return [
        {
            "name": f"{name}, baseline in C" if ratio is not None else f"{name} ({message})",
            "value": took["compiled"],
            "unit": "us",
            "baseline": took.get("C"),
            "ratio": ratio,
            "goal": f"<= {GOAL_RATIO}x",
            "met": None if ratio is None else ratio <= GOAL_RATIO,
        },
        {"name": f"{name}, baseline a loop in Python", "value": took["compiled"], "unit": "us",
         "baseline": took["Python"], "ratio": took["compiled"] / took["Python"]},
    ]  # fmt: skip


def _c_loop(table: DeliveryTable, batch: Batch) -> tuple[Callable[[], object] | None, str]:
    """The loop in C over the same sockets, and the compiler's command; or None and the reason."""
    library, message = load_library("udp_send")
    if library is None:
        return None, message
    count = len(table.rows)
    descriptors = np.ascontiguousarray(table.rows["descriptor"])
    order = np.random.default_rng(1).permutation(count).astype(np.int64)
    results = np.zeros(count, dtype=np.int64)
    arrays = (descriptors, order, batch.text, batch.starts, batch.lengths, results)
    addresses = [ctypes.c_void_p(array.ctypes.data) for array in arrays]
    call = (*addresses[:2], ctypes.c_int64(count), *addresses[2:])
    library.send_in_order.restype = ctypes.c_int64
    return lambda: (library.send_in_order(*call), arrays)[0], message


def _medians_us(methods: list[Callable[[], object]], clients: list[socket.socket]) -> list[float]:
    """Median duration of each method [us]. They take turns in being first."""
    seconds: list[list[float]] = [[] for _ in methods]
    for number in range(ROUNDS):
        for turn in range(len(methods)):
            index = (number + turn) % len(methods)
            began = time.perf_counter()
            methods[index]()
            seconds[index].append(time.perf_counter() - began)
            for client in clients:
                assert client.recv(2048) == DATAGRAM
    return [float(np.median(took[len(took) // 10 :])) * US_PER_S for took in seconds]
