"""Histograms of the times of every task, and of the lags.

Counts begin at the start of the process that counts and only grow while it runs: the difference of two answers is the
histogram of the time between them. Quantiles are over everything counted since the start.
"""

from collections.abc import Mapping
from typing import Literal

import numpy as np

from app.web.blackboard import Timings
from app.web.reports.base import Report
from vision_core.clock import MS_PER_S
from vision_core.rtdb.items import Timed
from vision_core.timing.histogram import EDGES_S, Counts, quantile_s

DIGITS = 6
"""Decimals of milliseconds: nanoseconds."""
UPPER_MS = np.round(EDGES_S[1:] * MS_PER_S, DIGITS)


class Histogram(Report):
    """A histogram of durations; quantiles are null without durations."""

    unit: Literal["ms"] = "ms"
    count: int
    """Number of durations."""
    p50: float | None
    """Median."""
    p90: float | None
    p99: float | None
    p99_9: float | None
    max: float | None
    """Upper end of the bin with the longest duration; bins are 3 % wide."""
    bins: list[tuple[float, int]]
    """Upper end [ms] and count of each bin that is not empty."""


class TaskTiming(Report):
    """The times of one task since the start of its process."""

    name: str
    age_s: float
    """Time since it last wrote them [s]."""
    valid: bool
    """They are recent enough to be believed."""
    lateness: Histogram
    """From the trigger to the beginning of the run."""
    execution: Histogram
    """From the beginning to the end of the run."""
    response: Histogram
    """From the trigger to the end of the run."""
    interval: Histogram
    """Between the beginnings of two runs."""


class LagTiming(Report):
    """The three parts of the lag from an event on the field to the robot program's reaction."""

    server: Histogram | None
    """A: from the grab of an image to the last client's datagram; null before the first."""
    network: Histogram | None
    """B: from the server to the client, over the clients that report it; null without reports."""
    client: Histogram | None
    """C: until the client's program has used the view, over the clients that report it; null without reports."""
    shutter_delay_ms: float
    """From the shutter to the grab, as configured [ms]; it comes before A."""
    age_s: float | None
    """Time since they were last written [s]; null: never."""
    valid: bool
    """They are recent enough to be believed."""


class Timing(Report):
    """All times at one instant."""

    tasks: list[TaskTiming]
    """Tasks that have run, in the table's order."""
    lags: LagTiming


def timing_from(timings: Timings, shutter_delay_ms: float) -> Timing:
    """The report of all histograms."""
    return Timing(
        tasks=[_task(name, timed) for name, timed in timings.tasks.items()],
        lags=_lags(timings.lags, shutter_delay_ms),
    )


def _task(name: str, timed: Timed[Mapping[str, Counts]]) -> TaskTiming:
    return TaskTiming(
        name=name,
        age_s=timed.age_s,
        valid=timed.valid,
        lateness=histogram_from(timed.value["lateness"]),
        execution=histogram_from(timed.value["execution"]),
        response=histogram_from(timed.value["response"]),
        interval=histogram_from(timed.value["interval"]),
    )


def _lags(timed: Timed[Mapping[str, Counts]] | None, shutter_delay_ms: float) -> LagTiming:
    counted = {name: histogram_from(counts) for name, counts in timed.value.items() if counts.any()} if timed else {}
    return LagTiming(
        server=counted.get("server"),
        network=counted.get("network"),
        client=counted.get("client"),
        shutter_delay_ms=shutter_delay_ms,
        age_s=timed.age_s if timed else None,
        valid=timed is not None and timed.valid,
    )


def histogram_from(counts: Counts) -> Histogram:
    """The report of one histogram; counts of shape (n,)."""
    filled = np.flatnonzero(counts)
    p50, p90, p99, p99_9 = (_ms(quantile_s(counts, share)) for share in (0.5, 0.9, 0.99, 0.999))
    return Histogram(
        count=int(counts.sum()),
        p50=p50,
        p90=p90,
        p99=p99,
        p99_9=p99_9,
        max=float(UPPER_MS[filled[-1]]) if filled.size else None,
        bins=list(zip(UPPER_MS[filled].tolist(), counts[filled].tolist(), strict=True)),
    )


def _ms(duration_s: float | None) -> float | None:
    return None if duration_s is None else round(duration_s * MS_PER_S, DIGITS)
