"""Ten clients written from the paper's text, on the demo, for a minute.

Beside them a sleeper on each core asks for 1 ms again and again: when the machine stands still, it shows
that the machine did. A frame that a client misses is our own fault unless a sleeper overslept by 10 ms or
more at the same moment.
"""

import itertools
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from bench.service import RunningService, running_service

PAPER_CLIENT = Path(__file__).with_name("paper_client.py")
SLEEPER = Path(__file__).with_name("sleeper.py")
PERIOD_S = 1.0 / 30.0
STALL_S = 0.010
NEAR_S = 0.1
"""A stall so long before a missing frame was due still explains it."""

BEFORE_END_S = 1.0
"""The server is asked for its lags while everybody is served: without clients it has none."""

Report = dict[str, Any]


def run(seconds: float = 60.0) -> list[dict[str, Any]]:
    """Start the service and ten clients; returns the rows of the table."""
    with running_service() as service:
        sleepers = Sleepers()
        clients = [_client(service, team, number, seconds) for team in ("blue", "yellow") for number in range(1, 6)]
        time.sleep(seconds - BEFORE_END_S)
        status, tasks = service.get("/api/v1/status")[1], service.get("/api/v1/tasks")[1]
        boot_s = time.monotonic() - status["uptime_s"]
        reports = [json.loads(client.communicate()[0]) for client in clients]
        sleepers.stop()
    rows = [row for report in reports for row in _client_rows(report, sleepers, boot_s)]
    return [*rows, *sleepers.rows(), *_status_rows(status, tasks)]


class Sleepers:
    """One on each core; see ``bench/sleeper.py``."""

    def __init__(self) -> None:
        self._processes = [_started(SLEEPER, str(core)) for core in sorted(os.sched_getaffinity(0))]
        self.reports: list[Report] = []

    def stop(self) -> None:
        """End their sleep and take their reports."""
        self.reports = [json.loads(process.communicate()[0]) for process in self._processes]

    def stood_still_between(self, start_s: float, end_s: float) -> bool:
        """Did a core stand still at any time in between [s of the monotonic clock]?"""
        naps = [nap for report in self.reports for nap in report["overslept"]]
        return any(late > STALL_S and woke > start_s and woke - late < end_s for woke, late in naps)

    def rows(self) -> list[dict[str, Any]]:
        """How late they woke."""
        rows: list[dict[str, Any]] = []
        for core, report in enumerate(self.reports):
            late = [late for _, late in report["overslept"]]
            name = f"sleeper on core {core} ({report['policy']}), 1 ms"
            rows.append({"name": f"{name}: naps", "value": report["naps"], "unit": ""})
            rows.append({"name": f"{name}: latest", "value": round(max(late, default=0.0) * 1e3, 1), "unit": "ms"})
            rows.append({"name": f"{name}: over 10 ms late", "value": sum(v > STALL_S for v in late), "unit": "times"})
        return rows


def _client(service: RunningService, team: str, number: int, seconds: float) -> "subprocess.Popen[str]":
    arguments = [team, str(number), str(seconds), "127.0.0.1", str(service.udp_port)]
    return _started(PAPER_CLIENT, *arguments)


def _started(script: Path, *arguments: str) -> "subprocess.Popen[str]":
    command = [sys.executable, str(script), *arguments]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def _client_rows(report: Report, sleepers: Sleepers, boot_s: float) -> list[dict[str, Any]]:
    ours, machine = 0, 0
    for before, after in itertools.pairwise(report["times"]):
        skipped = round((after - before) / PERIOD_S) - 1
        if sleepers.stood_still_between(boot_s + before - NEAR_S, boot_s + after):
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


def _status_rows(status: Report, tasks: list[Report]) -> list[dict[str, Any]]:
    """What the service says of itself."""
    lag = status["lags"]["server"] or {}
    rows = [{"name": f"server's lag, {key[:-3]}", "value": round(lag[key], 2), "unit": "ms"} for key in sorted(lag)]
    missed = {task["name"]: task["missed"] for task in tasks}
    return [
        *rows,
        *(
            {"name": f"frames missed by {name}, as it says", "value": missed[name], "unit": ""}
            for name in ("capture", "perceive", "serve")
        ),
    ]
