"""Every process of a running service is killed and stopped in turn (SIGKILL, SIGSTOP), with ten clients connected.

Back is a process when a successor has written its tasks' records and does their work: for tasks on the way from a frame
to its datagrams, when the clients hear of a frame that was grabbed after the fault; for the page, when /readyz answers
200; for the others, when their records are fresh again. All of it is read from the database, where it lies.

The clients (``receiver``) say init once and nothing ever after; ``freshness`` doubts everything that is called valid.
Faults come one at a time, when the service is whole and a spare is warm again, and at most three a minute for a task.
At the end, apart: a task that is killed five times within a minute, and the supervisor (``endings``).
"""

import contextlib
import signal
import time
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.fault_targets import FaultTarget, Service
from bench.helpers import Companion, Report, sit_out, stepwise
from bench.runner import Row
from bench.service import configured, running_service
from bench.shutdown import disabling, killed_supervisor
from vision_core.clock import NS_PER_S, Instant
from vision_core.net.control import attach_to
from vision_core.rtdb import records

CLIENTS_PER_TEAM = 5
SIGNALS = (signal.SIGKILL, signal.SIGSTOP)
SETTLE_S = 1.0
LEASE_S = 4 * 3600.0
"""So long a client may be silent: all of them are, for the whole benchmark."""
MINUTE_S, MAX_A_MINUTE = 60.0, 3
STALE_S = 0.5
"""Older than that no view may be when a client gets it."""
AFTERWARDS_S = 0.5
"""A silence that begins so long after a process is back is not about it any more."""
NS_PER_US = 1000


@dataclass(frozen=True, slots=True)
class Fault:
    """What was done, and what came of it."""

    target: FaultTarget
    how: signal.Signals
    struck: Instant
    back_s: float


def run(rounds: int = 20) -> list[Row]:
    """So many rounds: each strikes every process twice."""
    with contextlib.ExitStack() as stack:
        path = stack.enter_context(configured(f"protocol.lease_s = {LEASE_S}"))
        running = stack.enter_context(running_service("--config", path))
        attached = attach_to(running.control)
        service = Service(running, attached)
        service.wait_until_complete()
        receiver = stack.enter_context(Companion("bench.receiver", running.udp_port, CLIENTS_PER_TEAM))
        doubter = stack.enter_context(Companion("bench.freshness", running.control))
        sit_out(SETTLE_S, "faults: settling")
        opened = _sessions(service)
        faults, waited_s = _strike_all(service, rounds)
        sit_out(SETTLE_S, "faults: settling")
        lost = len(opened ^ _sessions(service))
        heard, doubts = receiver.finish(), doubter.finish()
        rows = [*_fault_rows(faults, heard), *_client_rows(heard, attached.boot, lost), *_doubt_rows(doubts)]
        rows.append({"name": "longest wait for a warm spare before a fault", "value": round(waited_s, 1), "unit": "s"})
        rows += disabling(service)
        attached.close()
        rows += killed_supervisor(running)
    return rows


def _sessions(service: Service) -> set[tuple[str, int, int, Instant]]:
    """Every client's session: whose it is, at which port, and since when."""
    serving = records.SERVING.reader(service.attached.store).value(Instant(time.monotonic_ns()))
    return {(str(client.team), client.number, client.port, client.since) for client in serving.clients}


def _strike_all(service: Service, rounds: int) -> tuple[list[Fault], float]:
    """All faults, and the longest wait before one [s]."""
    turns = [(target, how) for how in SIGNALS for target in service.targets()] * rounds
    struck: dict[str, list[float]] = defaultdict(list)
    faults, longest_s = [], 0.0
    for target, how in stepwise(turns, "faults"):
        longest_s = max(longest_s, service.wait_until_complete())
        time.sleep(max(SETTLE_S, _too_soon_s(struck[target.name])))
        service.wait_until_complete()
        struck[target.name].append(time.monotonic())
        faults.append(Fault(target, how, *service.strike(target, how)))
    return faults, longest_s


def _too_soon_s(struck: list[float]) -> float:
    """How long to wait for a process's next fault, so that there are not too many within a minute [s]."""
    return struck[-MAX_A_MINUTE] + MINUTE_S - time.monotonic() if len(struck) >= MAX_A_MINUTE else 0.0


def _fault_rows(faults: list[Fault], heard: Report) -> list[Row]:
    """By process, in the order in which they were struck."""
    to_all = sorted(last for _, count, _, last in heard["views"] if count == heard["clients"])
    arrivals = np.array(to_all, dtype=np.int64)
    rows: list[Row] = []
    for name in dict.fromkeys(fault.target.name for fault in faults):
        ours = [fault for fault in faults if fault.target.name == name]
        silences = [silence_after(arrivals, fault.struck, fault.back_s) for fault in ours]
        rows.append(_back_row(ours, [until_s for _, until_s in silences]))
        longest_s = max(silence_s for silence_s, _ in silences)
        rows.append({"name": f"{name}: clients' longest silence", "value": round(longest_s, 3), "unit": "s"})
    return rows


def _back_row(faults: list[Fault], heard_again_s: Iterable[float]) -> Row:
    """The worst of a process's faults."""
    target = faults[0].target
    back_s = [fault.back_s for fault in faults]
    if target.on_frame_path:
        back_s = [max(both) for both in zip(back_s, heard_again_s, strict=True)]
    worst = int(np.argmax(back_s))
    words = f"worst of {len(faults)} ({faults[worst].how.name}), median {np.median(back_s):.2f} s"
    row: Row = {"name": f"{target.name}: back after, {words}", "value": round(back_s[worst], 3), "unit": "s"}
    if target.limit_s is None:
        return row
    return row | {"goal": f"<= {target.limit_s:g} s", "met": back_s[worst] <= target.limit_s}


def silence_after(arrivals: NDArray[np.int64], struck: int, back_s: float) -> tuple[float, float]:
    """The longest silence because of a fault, and from the fault to its end [s]. arrivals: ascending [ns]."""
    ends = arrivals[1:]
    about = (ends > struck) & (arrivals[:-1] < struck + round((back_s + AFTERWARDS_S) * NS_PER_S))
    if not about.any():
        return float("inf"), float("inf")
    longest = int(np.argmax(np.where(about, np.diff(arrivals), 0)))
    return float(ends[longest] - arrivals[longest]) / NS_PER_S, float(ends[longest] - struck) / NS_PER_S


def _client_rows(heard: Report, boot: Instant, lost: int) -> list[Row]:
    """What the clients say."""
    ages_s = [(last - boot - time_us * NS_PER_US) / NS_PER_S for time_us, _, _, last in heard["views"]]
    stale = sum(age_s > STALE_S for age_s in ages_s)
    anew = len(heard["ports"]) - 1
    return [
        {"name": f"views that {heard['clients']} clients got", "value": sum(view[1] for view in heard["views"])},
        _none("sessions that were lost or opened anew", lost),
        _none("ports of the server that clients had to change to", anew),
        _none("views whose Time is not greater than the one before", heard["disordered"]),
        _none("other messages to clients", len(heard["errors"])),
        _none(f"views older than {STALE_S} s when they came", stale),
        {"name": "the oldest view when it came", "value": round(max(ages_s, default=0.0), 3), "unit": "s"},
        {"name": f"clients: {heard['policy']}"},
    ]


def _doubt_rows(doubts: Report) -> list[Row]:
    return [
        {"name": "reads of records, 100 times a second", "value": doubts["reads"]},
        {"name": "of these called valid", "value": doubts["valid"]},
        _none("stale values served as fresh", len(doubts["wrong"])),
        *({"name": f"  {what}"} for what in doubts["wrong"][:5]),
    ]


def _none(name: str, count: int) -> Row:
    return {"name": name, "value": count, "goal": "0", "met": count == 0}
