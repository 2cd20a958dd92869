"""The metrics that Prometheus collects from ``/metrics``.

Histograms have two buckets per octave, merged from the 32 bins per octave of the database. Their sums are computed from
the middles of these bins, which are 3 % wide.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict

import numpy as np
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector

from app.web.blackboard import Blackboard, ServiceSnapshot, Timings
from app.web.health.monitor import Health, HealthMonitor
from app.web.health.readiness import process_of
from app.web.live.connection import Live
from vision_core.clock import seconds_between
from vision_core.rtdb import records
from vision_core.rtdb.infos import LAGS, TIMINGS
from vision_core.rtdb.process_state import ProcessState
from vision_core.timing.histogram import EDGES_S, PER_OCTAVE, Counts
from vision_core.types.objects import Team

FIRST_S, LAST_S = 8e-6, 4.2
STEP = PER_OCTAVE // 2
BOUNDS = tuple(index for index in range(1, EDGES_S.size, STEP) if FIRST_S < EDGES_S[index] < LAST_S)
"""Indices of the bin edges at which buckets end."""
MIDDLES_S = (EDGES_S[:-1] + EDGES_S[1:]) / 2.0
LABELS = ("task", "process")
TIMES = {
    "lateness": "From the trigger to the beginning of the run",
    "execution": "From the beginning to the end of a run",
    "response": "From the trigger to the end of the run",
    "interval": "Between the beginnings of two runs",
}
TALLIES = {
    "runs": "Runs since the task's start",
    "missed": "Triggers that were followed by no run",
    "overruns": "Runs longer than the budget",
    "collections": "Garbage collections, all between two runs",
}
LIVING = (ProcessState.RUNNING, ProcessState.DONE)


class ServiceCollector(Collector):
    """Reads the blackboard at every collection."""

    def __init__(self, blackboard: Blackboard, monitor: HealthMonitor, live: Live) -> None:
        self._blackboard = blackboard
        self._monitor = monitor
        self._live = live

    def describe(self) -> list[Metric]:
        """Nothing: the names come with the values."""
        return []

    def collect(self) -> Iterator[Metric]:
        """All metrics at this instant."""
        snapshot, timings = self._blackboard.read(), self._blackboard.timings()
        yield from _service(snapshot, self._monitor.judge(snapshot))
        yield GaugeMetricFamily("pslv_pages", "Pages that are open", value=self._live.pages)
        yield from _processes(snapshot)
        yield from _clients(snapshot)
        yield from _tasks(snapshot)
        yield from _rehearsals(snapshot)
        yield from _times(snapshot, timings)
        yield _lags(timings)


def _service(snapshot: ServiceSnapshot, health: Health) -> Iterator[Metric]:
    service = snapshot.service
    built = GaugeMetricFamily("pslv_build_info", "Version of the service", labels=["version"])
    built.add_metric([service.version], 1)
    yield built
    uptime_s = seconds_between(service.boot, snapshot.now)
    yield GaugeMetricFamily("pslv_uptime_seconds", "Since the start of the service", value=uptime_s)
    yield GaugeMetricFamily("pslv_ready", "1 while robots are served, as /readyz says", value=health.is_ready)
    causes = len(health.degradations)
    yield GaugeMetricFamily("pslv_degradations", "Causes of worse service, as /readyz lists them", value=causes)
    images = snapshot.frame.number if snapshot.frame else 0
    yield CounterMetricFamily("pslv_frames", "Images since the start of the service", value=images)
    delay_s = snapshot.camera.shutter_delay_ms / 1e3
    yield GaugeMetricFamily("pslv_shutter_delay_seconds", "From the shutter to the grab, as configured", value=delay_s)


def _processes(snapshot: ServiceSnapshot) -> Iterator[Metric]:
    alive = GaugeMetricFamily("pslv_process_up", "1 while a process runs or has ended well", labels=["process"])
    restarts = CounterMetricFamily("pslv_process_restarts", "Restarts of a process", labels=["process"])
    report = snapshot.of(records.PROCESSES)
    for process in report.value.processes if report else ():
        alive.add_metric([process.name], process.state in LIVING)
        restarts.add_metric([process.name], process.restarts)
    yield from (alive, restarts)


def _clients(snapshot: ServiceSnapshot) -> Iterator[Metric]:
    serving = snapshot.recent(records.SERVING)
    served = serving.value.clients if serving else ()
    connected = GaugeMetricFamily("pslv_clients", "Robots' programs that are connected", labels=["team"])
    for team in Team:
        connected.add_metric([team], sum(client.team is team for client in served))
    yield connected
    datagrams = CounterMetricFamily("pslv_datagrams", "Datagrams of clients and strangers", labels=["fate"])
    for fate, count in asdict(serving.value.datagrams).items() if serving else ():
        datagrams.add_metric([fate], count)
    yield datagrams


def _tasks(snapshot: ServiceSnapshot) -> Iterator[Metric]:
    reported = {name: timed.value for name, timed in snapshot.tasks.items() if timed.valid}
    enabled = GaugeMetricFamily("pslv_task_enabled", "0 while a task is switched off", labels=LABELS)
    for name, info in reported.items():
        enabled.add_metric([name, info.process], info.times.enabled)
    yield enabled
    for tally, words in TALLIES.items():
        family = CounterMetricFamily(f"pslv_task_{tally}", words, labels=LABELS)
        for name, info in reported.items():
            family.add_metric([name, info.process], getattr(info, tally))
        yield family


def _rehearsals(snapshot: ServiceSnapshot) -> Iterator[Metric]:
    counted = CounterMetricFamily("pslv_task_rehearsals", "Rehearsals of a task", labels=[*LABELS, "outcome"])
    spent = CounterMetricFamily("pslv_task_rehearsal_seconds", "Spent in rehearsals and watching", labels=LABELS)
    for name, timed in snapshot.tasks.items():
        if timed.valid and (rehearsals := timed.value.rehearsals):
            for outcome in ("rehearsed", "cut_short", "skipped"):
                counted.add_metric([name, timed.value.process, outcome], getattr(rehearsals, outcome))
            spent.add_metric([name, timed.value.process], rehearsals.spent_s)
    yield from (counted, spent)


def _times(snapshot: ServiceSnapshot, timings: Timings) -> Iterator[Metric]:
    for kind in TIMINGS:
        family = HistogramMetricFamily(f"pslv_task_{kind}_seconds", TIMES[kind], labels=LABELS)
        for name, timed in timings.tasks.items():
            if timed.valid:
                _add(family, (name, process_of(name, snapshot)), timed.value[kind])
        yield family


def _lags(timings: Timings) -> Metric:
    family = HistogramMetricFamily(
        "pslv_lag_seconds",
        "Lags A (server: grab to the last datagram), B (network) and C (client), these two as clients report them",
        labels=["part"],
    )
    counts: Mapping[str, Counts] = timings.lags.value if timings.lags and timings.lags.valid else {}
    for part in LAGS:
        if part in counts and counts[part].any():
            _add(family, (part,), counts[part])
    return family


def _add(family: HistogramMetricFamily, labels: tuple[str, ...], counts: Counts) -> None:
    below = np.concatenate([[0], np.cumsum(counts)])
    buckets = [(str(float(EDGES_S[index])), float(below[index])) for index in BOUNDS]
    family.add_metric(labels, [*buckets, ("+Inf", float(below[-1]))], sum_value=float(counts @ MIDDLES_S))
