"""What ten clients notice of a flood of datagrams at the server's ports.

Setup: the running service with its simulated camera at 30 Hz and ten clients. For each kind of flood, blocks of 4 s
take turns: no flood, the flood at the server's port, and the same flood at a socket here that nobody reads.
The simulated camera is an ordinary process and shares the cores with the sender, so the second comparison says
what the *server* makes of a flood. A view's lateness is the arrival of the frame's last view at its client minus the
grab of the image. The addresses 127.9.0.x are refused by the settings, as those of another network would be; 127.8.0.1
is an admitted address without a session.

For each flood: lateness at p99 minus that of the quiet blocks, and minus that beside the flood elsewhere (the
baselines), and views per second and client.
"""

import json
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from bench.flooder import KINDS, LOOPBACK, STRANGERS
from bench.helpers import Helper, with_progress
from bench.runner import Row
from bench.service import attached_service
from vision_core.clock import NS_PER_MS, NS_PER_S

Views = np.ndarray[tuple[int, int], np.dtype[np.int64]]
"""Time [us], clients, first and last arrival [ns] of each frame's views, shape (n, 4)."""

PER_TEAM = 5
CLIENTS = 2 * PER_TEAM
ROUNDS = 3
BLOCK_S = 4.0
SETTLE_S = 0.5
"""At the beginning of a block what the former block left behind is not counted."""
FLOODS = {
    "inits of one admitted address": ("main", 50_000),
    "inits of strangers": ("main", 40_000),
    "16 inits with mirrors of one admitted address": ("main", 3_000),
    "1 kB of strangers": ("session", 20_000),
}
"""The port and the datagrams a second of each kind."""
QUIET, ELSEWHERE, AT_SERVER = "quiet", "elsewhere", "at the server"
LATER_MS, RATE_HZ = 2.0, 29.9
"""Goals: at p99, and per client."""
SETTINGS = f"""
[admission]
refused = ["{STRANGERS}"]
"""


@dataclass(frozen=True, slots=True)
class Block:
    """A time in which a flood was sent."""

    name: str
    where: str
    start_ns: int
    end_ns: int
    sent_hz: float


def run() -> list[Row]:
    """Take turns of quiet and floods beside the service and its clients."""
    with ExitStack() as stack:
        service, attached = stack.enter_context(attached_service(SETTINGS))
        receiver = stack.enter_context(Helper("bench.receiver", service.udp_port, PER_TEAM))
        sink = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        sink.bind((LOOPBACK, 0))
        ports = {QUIET: 0, ELSEWHERE: sink.getsockname()[1], AT_SERVER: service.udp_port}
        order = [(name, where) for _ in range(ROUNDS) for name in FLOODS for where in ports]
        blocks = [_block(name, where, ports[where]) for name, where in with_progress(order, "floods")]
        boot = attached.boot
        report = receiver.finish()
    views = np.array(report["views"], dtype=np.int64)
    return [row for name in FLOODS for row in _rows(name, blocks, views, boot)]


def _block(name: str, where: str, main_port: int) -> Block:
    """Send a flood for a while, or nothing."""
    port, rate_hz = FLOODS[name]
    sent_hz = 0.0
    if where == QUIET:
        time.sleep(BLOCK_S)
    else:
        target = main_port + (where == AT_SERVER and port == "session")
        command = [sys.executable, "-m", "bench.flooder", str(target), name, str(rate_hz), str(BLOCK_S)]
        done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=10 * BLOCK_S)
        sent_hz = json.loads(done.stdout)["sent"] / BLOCK_S
    now = time.monotonic_ns()
    return Block(name, where, now - round(BLOCK_S * NS_PER_S), now, sent_hz)


def _rows(name: str, blocks: Sequence[Block], views: Views, boot: int) -> list[Row]:
    own = {where: [b for b in blocks if (b.name, b.where) == (name, where)] for where in (QUIET, ELSEWHERE, AT_SERVER)}
    seen = {where: _seen(those, views, boot) for where, those in own.items()}
    asked, sent = FLOODS[name][1], float(np.mean([block.sent_hz for block in own[AT_SERVER]]))
    title = f"{name}, {len(KINDS[name].datagram)} B"
    late_ms, views_hz = seen[AT_SERVER]
    rows: list[Row] = [
        {"name": f"{title}: sent", "value": round(sent), "unit": "1/s", "baseline": asked, "ratio": sent / asked}
    ]
    for where, than in ((QUIET, "without"), (ELSEWHERE, "beside the same flood elsewhere")):
        before_ms, before_hz = seen[where]
        rows += [
            {
                "name": f"{title}: later at p99 than {than}", "value": late_ms - before_ms, "unit": "ms",
                "baseline": before_ms, "ratio": late_ms / before_ms, "goal": f"<= {LATER_MS:g}",
                "met": late_ms - before_ms <= LATER_MS,
            },
            {
                "name": f"{title}: views per client, against {than}", "value": views_hz, "unit": "1/s",
                "baseline": before_hz, "ratio": views_hz / before_hz, "goal": f">= {RATE_HZ:g}",
                "met": views_hz >= RATE_HZ,
            },
        ]  # fmt: skip
    return rows


def _seen(blocks: Sequence[Block], views: Views, boot: int) -> tuple[float, float]:
    """Lateness at p99 [ms], and views per second and client."""
    grabbed, clients, last = views[:, 0] * 1000 + boot, views[:, 1], views[:, 3]
    counted = np.zeros(len(views), dtype=bool)
    seconds = 0.0
    for block in blocks:
        start = block.start_ns + round(SETTLE_S * NS_PER_S)
        counted |= (grabbed >= start) & (grabbed < block.end_ns)
        seconds += (block.end_ns - start) / NS_PER_S
    late_ms = np.repeat((last - grabbed)[counted] / NS_PER_MS, clients[counted])
    return float(np.percentile(late_ms, 99)), float(clients[counted].sum() / CLIENTS / seconds)
