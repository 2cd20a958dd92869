"""Messages that ten clients of the running service receive within a minute.

Setup: the service with its simulated camera at 30 Hz, and ten client processes that follow the text of the paper only
(``paper_client``). There is no baseline.

For each client: messages per second, messages that do not have the paper's form (0 is expected), whether Time strictly
increases, and the number of skipped frames. A stall detector runs on each core: a frame that was skipped while a core
stalled for 10 ms or more is attributed to the machine, every other one to the service. The last rows are figures that
the service reports: its lag from grab to datagram [ms], and the frames that its tasks missed.
"""

import itertools
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from bench.runner import Row
from bench.service import RunningService, running_service
from vision_core.clock import MS_PER_S

PAPER_CLIENT = Path(__file__).with_name("paper_client.py")
STALL_DETECTOR = Path(__file__).with_name("stall_detector.py")
PERIOD_S = 1.0 / 30.0
STALL_S = 0.010
BEFORE_FRAME_S = 0.1
"""A skipped frame is attributed to a stall that ended at most so long before the frame."""
BEFORE_END_S = 1.0
"""The status is read so long before the clients end, since the service reports no lags without clients."""

Report = dict[str, Any]


def run(seconds: float = 60.0) -> list[Row]:
    """Start the service and ten clients for some seconds."""
    with running_service() as service:
        detectors = StallDetectors()
        clients = [_client(service, team, number, seconds) for team in ("blue", "yellow") for number in range(1, 6)]
        time.sleep(seconds - BEFORE_END_S)
        status, tasks = service.get("/api/v1/status")[1], service.get("/api/v1/tasks")[1]
        boot_s = time.monotonic() - status["uptime_s"]
        reports = [json.loads(client.communicate()[0]) for client in clients]
        detectors.stop()
    rows = [row for report in reports for row in _client_rows(report, detectors, boot_s)]
    return [*rows, *detectors.rows(), *_status_rows(status, tasks)]


class StallDetectors:
    """One stall detector on each core; see ``bench/stall_detector.py``."""

    def __init__(self) -> None:
        self._processes = [_started(STALL_DETECTOR, str(core)) for core in sorted(os.sched_getaffinity(0))]
        self.reports: list[Report] = []

    def stop(self) -> None:
        """End them and collect their reports."""
        self.reports = [json.loads(process.communicate()[0]) for process in self._processes]

    def has_stalled_between(self, start_s: float, end_s: float) -> bool:
        """Did any core stall between two instants [s of CLOCK_MONOTONIC]?"""
        late_wakeups = [wakeup for report in self.reports for wakeup in report["late"]]
        return any(late_s > STALL_S and woke > start_s and woke - late_s < end_s for woke, late_s in late_wakeups)

    def rows(self) -> list[Row]:
        """For each core the number of sleeps, the latest wake-up and the number of stalls."""
        rows: list[Row] = []
        for core, report in enumerate(self.reports):
            late_s = [late for _, late in report["late"]]
            name = f"stall detector on core {core} ({report['policy']}), sleeps of 1 ms"
            latest_ms = round(max(late_s, default=0.0) * MS_PER_S, 1)
            rows.append({"name": f"{name}: count", "value": report["sleeps"], "unit": ""})
            rows.append({"name": f"{name}: latest wake-up", "value": latest_ms, "unit": "ms"})
            rows.append(
                {"name": f"{name}: over 10 ms late", "value": sum(late > STALL_S for late in late_s), "unit": ""}
            )
        return rows


def _client(service: RunningService, team: str, number: int, seconds: float) -> "subprocess.Popen[str]":
    arguments = [team, str(number), str(seconds), "127.0.0.1", str(service.udp_port)]
    return _started(PAPER_CLIENT, *arguments)


def _started(script: Path, *arguments: str) -> "subprocess.Popen[str]":
    command = [sys.executable, str(script), *arguments]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def _client_rows(report: Report, detectors: StallDetectors, boot_s: float) -> list[Row]:
    """Rows of one client; boot_s: instant of Time 0 [s of CLOCK_MONOTONIC]."""
    by_service, by_machine = 0, 0
    for before, after in itertools.pairwise(report["times"]):
        skipped = round((after - before) / PERIOD_S) - 1
        if detectors.has_stalled_between(boot_s + before - BEFORE_FRAME_S, boot_s + after):
            by_machine += skipped
        else:
            by_service += skipped
    name = f"{report['team']} {report['number']}"
    return [
        {"name": f"{name}: messages", "value": round(report["per_second"], 2), "unit": "1/s"},
        {"name": f"{name}: messages not of the paper's form", "value": report["wrong_form"], "unit": ""},
        {"name": f"{name}: Time strictly increases", "value": report["increasing"], "unit": ""},
        {"name": f"{name}: frames skipped by the service", "value": by_service, "unit": ""},
        {"name": f"{name}: frames skipped while the machine stalled", "value": by_machine, "unit": ""},
    ]


def _status_rows(status: Report, tasks: list[Report]) -> list[Row]:
    """Figures that the service reports about itself."""
    lag = status["lags"]["server"] or {}
    rows = [
        {"name": f"lag of the server, {key[:-3]}", "value": round(lag[key], 2), "unit": "ms"} for key in sorted(lag)
    ]
    missed = {task["name"]: task["missed"] for task in tasks}
    return [
        *rows,
        *(
            {"name": f"frames missed by {name}, as /api/v1/tasks says", "value": missed[name], "unit": ""}
            for name in ("capture", "perceive", "serve")
        ),
    ]
