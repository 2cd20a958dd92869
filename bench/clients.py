"""Ten clients written from the paper's text, on the demo, for a minute.

Beside them runs a sleeper that asks for 1 ms: when the whole machine stands still, it shows that the
machine did. A frame that a client misses is our own fault unless the sleeper overslept by 10 ms or more
at the same moment.
"""

import itertools
import json
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

from bench.service import RunningService, running_service

PAPER_CLIENT = Path(__file__).with_name("paper_client.py")
PERIOD_S = 1.0 / 30.0
NAP_S = 0.001
STALL_S = 0.010
NEAR_S = 0.1
"""A stall so long before a missing frame was due still explains it."""

BEFORE_END_S = 1.0
"""The server is asked for its lags while everybody is served: without clients it has none."""

Report = dict[str, Any]


def run(seconds: float = 60.0) -> list[dict[str, Any]]:
    """Start the service and ten clients; returns the rows of the table."""
    with running_service() as service:
        sleeper = Sleeper()
        clients = [_client(service, team, number, seconds) for team in ("blue", "yellow") for number in range(1, 6)]
        time.sleep(seconds - BEFORE_END_S)
        status = service.get("/api/v1/status")[1]
        boot_s = time.monotonic() - status["uptime_s"]
        reports = [json.loads(client.communicate()[0]) for client in clients]
        sleeper.stop()
    rows = [row for report in reports for row in _client_rows(report, sleeper, boot_s)]
    return [*rows, *sleeper.rows(), *_lag_rows(status)]


class Sleeper:
    """Sleeps 1 ms again and again and notes how late it wakes."""

    def __init__(self) -> None:
        self._running = True
        self._wakes: list[tuple[float, float]] = []
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the sleep."""
        self._running = False
        self._thread.join()

    def stalled_between(self, start_s: float, end_s: float) -> bool:
        """Did the machine stand still at any time in between [s of the monotonic clock]?"""
        return any(late > STALL_S and woke > start_s and woke - late < end_s for woke, late in self._wakes)

    def rows(self) -> list[dict[str, Any]]:
        """How late it woke."""
        late = sorted(late for _, late in self._wakes)
        p99 = late[int(0.99 * len(late))]
        return [
            {"name": "sleeper, 1 ms: p99 lateness", "value": round(p99 * 1e3, 2), "unit": "ms"},
            {"name": "sleeper, 1 ms: max lateness", "value": round(late[-1] * 1e3, 2), "unit": "ms"},
            {"name": "sleeper, 1 ms: over 10 ms late", "value": sum(v > STALL_S for v in late), "unit": "times"},
        ]

    def _run(self) -> None:
        while self._running:
            asked = time.monotonic()
            time.sleep(NAP_S)
            woke = time.monotonic()
            self._wakes.append((woke, woke - asked - NAP_S))


def _client(service: RunningService, team: str, number: int, seconds: float) -> "subprocess.Popen[str]":
    arguments = [team, str(number), str(seconds), "127.0.0.1", str(service.udp_port)]
    return subprocess.Popen([sys.executable, str(PAPER_CLIENT), *arguments], stdout=subprocess.PIPE, text=True)


def _client_rows(report: Report, sleeper: Sleeper, boot_s: float) -> list[dict[str, Any]]:
    ours, machine = 0, 0
    for before, after in itertools.pairwise(report["times"]):
        skipped = round((after - before) / PERIOD_S) - 1
        if sleeper.stalled_between(boot_s + before - NEAR_S, boot_s + after):
            machine += skipped
        else:
            ours += skipped
    name = f"{report['team']} {report['number']}"
    return [
        {"name": f"{name}: messages", "value": round(report["per_second"], 2), "unit": "1/s"},
        {"name": f"{name}: not of the paper's form", "value": report["wrong_form"], "unit": ""},
        {"name": f"{name}: Time strictly increases", "value": report["increasing"], "unit": ""},
        {"name": f"{name}: frames skipped, our fault", "value": ours, "unit": ""},
        {"name": f"{name}: frames skipped, machine stood still", "value": machine, "unit": ""},
    ]


def _lag_rows(status: Report) -> list[dict[str, Any]]:
    lag = status["lag"]
    return [{"name": f"server's lag, {key[:-3]}", "value": round(lag[key], 2), "unit": "ms"} for key in sorted(lag)]
