"""How soon the service recovers when each of its processes is killed or stopped.

Setup: the running service with ten connected clients (``receiver``). Every process in turn gets SIGKILL, then every
process SIGSTOP, for some rounds. Faults come one at a time, when the service is healthy and a spare process is ready,
at most three a minute for each process. There is no baseline; the goals are limits for the recovery [s].

Recovery time [s]: from the signal until a successor does the work of the process. For a process on the frame path that
is when the clients receive a view of a frame that was grabbed after the fault; for the page when /readyz answers 200;
for all others when their records are fresh again. The worst and the median of all faults are given.

The clients send init once and never again, so a client that is served at the end never had to reconnect. The longest
time without a view is given for every process. ``freshness`` checks all records for stale values that are called valid.

At the end (``shutdown``): one task is killed five times within a minute and must be disabled; then the supervisor is
killed and nothing of the service may remain.
"""

import contextlib
import signal
import time
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.fault_targets import FaultTarget, ServiceUnderTest
from bench.helpers import Helper, Report, wait_with_progress, with_progress
from bench.runner import Row
from bench.service import configured, running_service
from bench.shutdown import kill_repeatedly, kill_supervisor
from vision_core.clock import NS_PER_S, NS_PER_US, Instant
from vision_core.net.control import attach_to
from vision_core.rtdb import records

CLIENTS_PER_TEAM = 5
SIGNALS = (signal.SIGKILL, signal.SIGSTOP)
SETTLE_S = 1.0
LEASE_S = 4 * 3600.0
"""Sessions survive so long without a message from the client: for the whole benchmark."""
MINUTE_S, MAX_PER_MINUTE = 60.0, 3
STALE_S = 0.5
"""A view that is older than that when a client receives it counts as stale."""
ATTRIBUTION_S = 0.5
"""A gap in the views that begins later than that after the recovery is not attributed to the fault."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One injected fault and its recovery."""

    target: FaultTarget
    signal: signal.Signals
    injected: Instant
    recovery_s: float


def run(rounds: int = 20) -> list[Row]:
    """Every round injects both signals into every process once."""
    with contextlib.ExitStack() as stack:
        path = stack.enter_context(configured(f"protocol.lease_s = {LEASE_S}"))
        running = stack.enter_context(running_service("--config", path))
        attached = attach_to(running.control)
        service = ServiceUnderTest(running, attached)
        service.wait_until_healthy()
        receiver = stack.enter_context(Helper("bench.receiver", running.udp_port, CLIENTS_PER_TEAM))
        checker = stack.enter_context(Helper("bench.freshness", running.control))
        wait_with_progress(SETTLE_S, "faults: settling")
        sessions = _sessions(service)
        faults, longest_wait_s = _inject_all(service, rounds)
        wait_with_progress(SETTLE_S, "faults: settling")
        changed = len(sessions ^ _sessions(service))
        received, freshness = receiver.finish(), checker.finish()
        rows = [
            *_fault_rows(faults, received),
            *_client_rows(received, attached.boot, changed),
            *_freshness_rows(freshness),
            {"name": "longest wait for a ready spare before a fault", "value": round(longest_wait_s, 1), "unit": "s"},
            *kill_repeatedly(service),
        ]
        attached.close()
        rows += kill_supervisor(running)
    return rows


def _sessions(service: ServiceUnderTest) -> set[tuple[str, int, int, Instant]]:
    """Every session: team, number, the server's port, and when it was opened."""
    serving = records.SERVING.reader(service.attached.store).value(Instant(time.monotonic_ns()))
    return {(str(client.team), client.number, client.port, client.since) for client in serving.clients}


def _inject_all(service: ServiceUnderTest, rounds: int) -> tuple[list[Fault], float]:
    """Inject all faults. Returns them and the longest wait until the service was healthy before one [s]."""
    plan = [(target, fault) for fault in SIGNALS for target in service.targets()] * rounds
    injected_s: dict[str, list[float]] = defaultdict(list)
    faults, longest_s = [], 0.0
    for target, fault in with_progress(plan, "faults"):
        longest_s = max(longest_s, service.wait_until_healthy())
        time.sleep(max(SETTLE_S, _pause_s(injected_s[target.name])))
        service.wait_until_healthy()
        injected_s[target.name].append(time.monotonic())
        faults.append(Fault(target, fault, *service.inject(target, fault)))
    return faults, longest_s


def _pause_s(injected_s: list[float]) -> float:
    """How long to wait before a process's next fault, so that there are at most MAX_PER_MINUTE [s]."""
    if len(injected_s) < MAX_PER_MINUTE:
        return 0.0
    return injected_s[-MAX_PER_MINUTE] + MINUTE_S - time.monotonic()


def _fault_rows(faults: list[Fault], received: Report) -> list[Row]:
    """Recovery and the clients' longest gap by process, in the order in which faults were injected."""
    complete = sorted(last for _, count, _, last in received["views"] if count == received["clients"])
    arrivals = np.array(complete, dtype=np.int64)
    rows: list[Row] = []
    for name in dict.fromkeys(fault.target.name for fault in faults):
        own = [fault for fault in faults if fault.target.name == name]
        gaps = [longest_gap(arrivals, fault.injected, fault.recovery_s) for fault in own]
        rows.append(_recovery_row(own, [until_s for _, until_s in gaps]))
        longest_s = max(gap_s for gap_s, _ in gaps)
        rows.append(
            {"name": f"{name}: clients' longest time without a view", "value": round(longest_s, 3), "unit": "s"}
        )
    return rows


def _recovery_row(faults: list[Fault], served_again_s: Iterable[float]) -> Row:
    """The worst and the median recovery of one process."""
    target = faults[0].target
    recovery_s = [fault.recovery_s for fault in faults]
    if target.is_on_frame_path:
        recovery_s = [max(both) for both in zip(recovery_s, served_again_s, strict=True)]
    worst = int(np.argmax(recovery_s))
    summary = f"worst of {len(faults)} ({faults[worst].signal.name}), median {np.median(recovery_s):.2f} s"
    row: Row = {"name": f"{target.name}: recovery, {summary}", "value": round(recovery_s[worst], 3), "unit": "s"}
    if target.limit_s is None:
        return row
    return row | {"goal": f"<= {target.limit_s:g} s", "met": recovery_s[worst] <= target.limit_s}


def longest_gap(arrivals: NDArray[np.int64], injected: int, recovery_s: float) -> tuple[float, float]:
    """The longest gap between views that is attributed to a fault, and the time from the fault to its end [s].

    arrivals: when the views arrived, ascending, shape (n,) [ns]. Both are infinite when no view came after the fault.
    """
    ends = arrivals[1:]
    attributed = (ends > injected) & (arrivals[:-1] < injected + round((recovery_s + ATTRIBUTION_S) * NS_PER_S))
    if not attributed.any():
        return float("inf"), float("inf")
    longest = int(np.argmax(np.where(attributed, np.diff(arrivals), 0)))
    return float(ends[longest] - arrivals[longest]) / NS_PER_S, float(ends[longest] - injected) / NS_PER_S


def _client_rows(received: Report, boot: Instant, changed: int) -> list[Row]:
    """What all clients together received."""
    ages_s = [(last - boot - time_us * NS_PER_US) / NS_PER_S for time_us, _, _, last in received["views"]]
    stale = sum(age_s > STALE_S for age_s in ages_s)
    views = sum(count for _, count, _, _ in received["views"])
    return [
        {"name": f"views received by {received['clients']} clients", "value": views},
        _zero_row("sessions that were lost or opened again", changed),
        _zero_row("changes of the server's port", len(received["ports"]) - 1),
        _zero_row("views whose Time is not greater than that of the view before", received["disordered"]),
        _zero_row("other messages to clients", len(received["errors"])),
        _zero_row(f"views older than {STALE_S} s at arrival", stale),
        {"name": "oldest view at arrival", "value": round(max(ages_s, default=0.0), 3), "unit": "s"},
        {"name": f"clients: {received['policy']}"},
    ]


def _freshness_rows(freshness: Report) -> list[Row]:
    return [
        {"name": "reads of records, 100 times a second", "value": freshness["reads"]},
        {"name": "of these called valid", "value": freshness["valid"]},
        _zero_row("stale values that were called valid", len(freshness["violations"])),
        *({"name": f"  {violation}"} for violation in freshness["violations"][:5]),
    ]


def _zero_row(name: str, count: int) -> Row:
    """A count whose goal is 0."""
    return {"name": name, "value": count, "goal": "0", "met": count == 0}
