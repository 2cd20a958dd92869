"""How exactly a client knows the server's clock, over simulated paths and over loopback.

Setup: the client's ``ClockSync`` on simulated time (``clock_paths``): a clock with skew and steps, and paths that
delay, lose, double and reorder, each with SEEDS seeds. Then ``connect`` on the running service, at rest and while every
core is busy: both clocks are CLOCK_MONOTONIC there, and the service says when its Time began, so the truth is known.

An error is what is told minus the truth, at up to 100 instants a second; the baseline is the middle of the last
exchange. The bound holds at an instant at which the truth is no farther than it. Between a step of a clock and the next
answer none can know of it: there the seconds are given until the error is below 1 ms.
"""

import numpy as np

from bench.clock_paths import CASES, simulate
from bench.load import full_load
from bench.runner import Row
from bench.service import RunningService, attached_service
from vision_core.client import connect
from vision_core.clock import US_PER_S, Instant, MonotonicClock, after, seconds_between
from vision_core.geometry import Floats

SEEDS = 20
STEP_AT_S, FOUND_S, GOAL_FOUND_S = 30.0, 1e-3, 10.0
GOALS_US = {"idle": 100.0, "loaded": 500.0, "drift": 200.0}
SECONDS = 30.0
"""On loopback, at rest and under load."""
LOOK_S = 0.01


def run(seconds: float = SECONDS) -> list[Row]:
    """All cases. seconds: how long each case on loopback lasts."""
    rows = [row for name in CASES if name != "step" for row in _simulated_rows(name)]
    rows.append(_step_row())
    with attached_service("") as (service, attached):
        rows += _rows("loopback", *_loopback(service, attached.boot, seconds), GOALS_US["idle"])
        with full_load():
            rows += _rows("loopback, all cores busy", *_loopback(service, attached.boot, seconds), GOALS_US["loaded"])
    return rows


def _simulated_rows(name: str) -> list[Row]:
    traces = [simulate(CASES[name], seed) for seed in range(SEEDS)]
    told = np.concatenate([trace.error_s for trace in traces])
    naive = np.concatenate([trace.naive_s - trace.at_s for trace in traces])
    bounds = np.concatenate([trace.bound_s for trace in traces])
    return _rows(name, told, bounds, GOALS_US.get(name), naive)


def _rows(
    name: str, error_s: Floats, bound_s: Floats, goal_us: float | None, naive_s: Floats | None = None
) -> list[Row]:
    """Error and bound at the same instants, and the error of the last exchange alone, if it is known."""
    p99_us, held = _p99_us(error_s), float(np.mean(np.abs(error_s) <= bound_s))
    row: Row = {"name": f"{name}: p99 of |error|", "value": p99_us, "unit": "us"}
    if goal_us is not None:
        row |= {"goal": f"< {goal_us:g} us", "met": p99_us < goal_us}
    if naive_s is not None:
        row |= {"baseline": _p99_us(naive_s), "ratio": p99_us / _p99_us(naive_s)}
    return [
        {"name": f"{name}: median |error|", "value": float(np.median(np.abs(error_s))) * US_PER_S, "unit": "us"},
        row,
        {"name": f"{name}: largest |error|", "value": float(np.abs(error_s).max()) * US_PER_S, "unit": "us"},
        {"name": f"{name}: median bound", "value": float(np.median(bound_s)) * US_PER_S, "unit": "us"},
        {"name": f"{name}: share of the time in which the bound held", "value": 100.0 * held, "unit": "%",
         "goal": "100 %", "met": held == 1.0},
    ]  # fmt: skip


def _p99_us(error_s: Floats) -> float:
    return float(np.percentile(np.abs(error_s), 99.0)) * US_PER_S


def _step_row() -> Row:
    found_s = []
    for seed in range(SEEDS):
        trace = simulate(CASES["step"], seed)
        lost = trace.at_s[(np.abs(trace.error_s) > FOUND_S) & (trace.at_s >= STEP_AT_S)]
        found_s.append(float(lost[-1]) - STEP_AT_S)
    longest_s = max(found_s)
    row: Row = {"name": "step of -1 s: longest time until found", "value": longest_s, "unit": "s"}
    return row | {"goal": f"< {GOAL_FOUND_S:g} s", "met": longest_s < GOAL_FOUND_S}


class NotingClock(MonotonicClock):
    """Notes what it has shown last: a process may be interrupted after it has looked."""

    last = Instant(0)

    def now(self) -> Instant:
        """CLOCK_MONOTONIC."""
        self.last = super().now()
        return self.last


def _loopback(service: RunningService, boot: Instant, seconds: float) -> tuple[Floats, Floats]:
    """Errors and bounds [s] on loopback, shape (n,) each."""
    clock, rows = NotingClock(), []
    with connect("127.0.0.1", service.udp_port, "blue", 1, clock=clock) as robot:
        end = after(clock.now(), seconds)
        while clock.now() < end:
            robot.receive(LOOK_S)
            time_s, bound_s = robot.server_time()
            rows.append((time_s - seconds_between(boot, clock.last), bound_s))
    known = np.array([row for row in rows if np.isfinite(row[1])]).reshape(-1, 2)
    return known[:, 0], known[:, 1]
