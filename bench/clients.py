"""Ten clients written from the paper's text, on the demo, for a minute.

Beside them runs a sleeper that asks for 1 ms: when the whole machine stands still, it shows that the
machine did. A frame is skipped by our own fault when its interval is longer than 1.5 periods and the
sleeper slept well.
"""

import itertools
import json
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

from bench.service import running_service

PAPER_CLIENT = Path(__file__).with_name("paper_client.py")
PERIOD_S = 1.0 / 30.0
LATE_SLEEP_S = 0.010


def run(seconds: float = 60.0) -> list[dict[str, Any]]:
    """Start the service and ten clients; returns one result per client and one of the sleeper."""
    with running_service() as service:
        robots = [(team, number) for team in ("blue", "yellow") for number in range(1, 6)]
        clients = [
            subprocess.Popen(
                [
                    sys.executable,
                    str(PAPER_CLIENT),
                    team,
                    str(number),
                    str(seconds),
                    "127.0.0.1",
                    str(service.udp_port),
                ],
                stdout=subprocess.PIPE,
                text=True,
            )
            for team, number in robots
        ]
        sleeper = Sleeper()
        reports = [json.loads(client.communicate()[0]) for client in clients]
        lateness = sleeper.stop()
        status = service.get("/api/v1/status")[1]
    return _results(reports, lateness, status)


class Sleeper:
    """Sleeps 1 ms again and again and notes how late it wakes."""

    def __init__(self) -> None:
        self._running = True
        self._late: list[float] = []
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while self._running:
            asked = time.monotonic()
            time.sleep(0.001)
            self._late.append(time.monotonic() - asked - 0.001)

    def stop(self) -> list[float]:
        """End; returns every lateness [s]."""
        self._running = False
        self._thread.join()
        return self._late


def _results(reports: list[dict[str, Any]], lateness: list[float], status: dict[str, Any]) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for report in reports:
        gaps = [later - earlier for earlier, later in itertools.pairwise(report["times"])]
        skipped = sum(round(gap / PERIOD_S) - 1 for gap in gaps if gap > 1.5 * PERIOD_S)
        name = f"{report['team']} {report['number']}"
        rows.append({"name": f"{name}: messages", "value": round(report["per_second"], 2), "unit": "1/s"})
        rows.append({"name": f"{name}: frames skipped", "value": skipped, "unit": ""})
        rows.append({"name": f"{name}: wrong form", "value": len(report["wrong"]), "unit": ""})
        rows.append({"name": f"{name}: Time increases", "value": report["increasing"], "unit": ""})
    late = sorted(lateness)
    rows.append(
        {"name": "sleeper 1 ms: p99 lateness", "value": round(late[int(0.99 * len(late))] * 1e3, 2), "unit": "ms"}
    )
    rows.append({"name": "sleeper 1 ms: max lateness", "value": round(late[-1] * 1e3, 2), "unit": "ms"})
    stalls = sum(value > LATE_SLEEP_S for value in late)
    rows.append({"name": "sleeper 1 ms: over 10 ms late", "value": stalls, "unit": "times"})
    lags = {key: status[key] for key in ("lag_median_ms", "lag_max_ms")}
    rows += [{"name": f"server {key}", "value": round(value, 2), "unit": "ms"} for key, value in lags.items()]
    return rows
