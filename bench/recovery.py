"""Kills the processes of a running service one by one (SIGKILL) and measures how long it misses them.

A client listens all the while: what it misses is the longest interval between two of its messages.
"""

import os
import signal
import threading
import time
from typing import Any

from bench.service import RunningService, is_alive, running_service
from vision_core.client.connection import Connection, connect

PATIENCE_S = 20.0
SETTLE_S = 3.0


def run(rounds: int = 3) -> list[dict[str, Any]]:
    """Kill every process some times, then the supervisor; returns the rows of the table."""
    rows: list[dict[str, Any]] = []
    with running_service() as service:
        listener = Listener(service.udp_port)
        opened_s: set[float] = set()
        for name in ("capture", "perceive", "serve", "web"):
            back, silent = zip(*(_kill(service, listener, name, opened_s) for _ in range(rounds)), strict=True)
            rows.append({"name": f"{name}: process back after, worst", "value": round(max(back), 2), "unit": "s"})
            rows.append({"name": f"{name}: client's longest silence", "value": round(max(silent), 2), "unit": "s"})
        time.sleep(SETTLE_S)
        opened_s.add(_opened_s(service))
        rows.append({"name": "sessions lost", "value": len(opened_s) - 1, "unit": ""})
        listener.stop()
        pids = [*service.pids().values(), service.process.pid]
        service.process.kill()
        time.sleep(1.0)
        left = sum(is_alive(pid) for pid in pids)
        rows.append({"name": "processes left 1 s after the supervisor's kill -9", "value": left, "unit": ""})
    return rows


class Listener:
    """A client in a thread that notes when its messages come."""

    def __init__(self, udp_port: int) -> None:
        self._connection: Connection = connect("127.0.0.1", udp_port, "blue", 1)
        self._running = True
        self.last = time.monotonic()
        self.longest = 0.0
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while self._running:
            if self._connection.receive(timeout_s=1.0) is None:
                continue
            now = time.monotonic()
            self.longest = max(self.longest, now - self.last)
            self.last = now

    def longest_silence_s(self) -> float:
        """The longest time between two messages, or since the last one."""
        return max(self.longest, time.monotonic() - self.last)

    def stop(self) -> None:
        """End."""
        self._running = False
        self._thread.join()
        self._connection.close()


def _opened_s(service: RunningService) -> float:
    """When the client's session was opened [s since the start of the service]."""
    status = service.get("/api/v1/status")[1]
    (client,) = status["clients"]
    opened_s: float = status["uptime_s"] - client["connected_s"]
    return round(opened_s, 3)


def _kill(service: RunningService, listener: Listener, name: str, opened_s: set[float]) -> tuple[float, float]:
    """Kill one process; returns seconds until its successor works, and the client's longest silence.

    Notes in opened_s when the client's session was opened: a lost one would be opened anew.
    """
    time.sleep(SETTLE_S)
    opened_s.add(_opened_s(service))
    victim = service.pids()[name]
    listener.longest = 0.0
    began = time.monotonic()
    os.kill(victim, signal.SIGKILL)
    while time.monotonic() - began < PATIENCE_S:
        time.sleep(0.02)
        try:
            if service.pids().get(name, victim) != victim and service.get("/readyz")[0] == 200:
                break
        except OSError:
            continue
    back = time.monotonic() - began
    time.sleep(0.5)
    return back, listener.longest_silence_s()
