"""Do twenty pages that watch the service delay its robots? At 200 Hz, in turns with pages and without.

Ten clients are connected all the while. For every frame ``stamps`` has three instants from the database: when capture
published it, when perceive wrote what it saw, and when serve had sent the last datagram. From the first to the last is
the way of the frame; beside it stand the tasks' own histograms, of how long their runs took. Blocks with pages and
without take turns, so that both see the same minutes of the machine; the interval of a ratio of p99 comes from drawing
blocks anew (bootstrap). Its bins are 3 % wide and interpolated (``vision_core.timing.histogram``).
"""

import contextlib
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.frame_path import FRAMES, SIGHTINGS, US_PER_S, VIEWS, WAY, WORKERS, histograms_of, policies_of
from bench.helpers import Companion, Report, sit_out
from bench.pictures import config_of, wait_for_all, write_match
from bench.record_timestamps import Stamp
from bench.runner import Row
from bench.service import RunningService, configured, running_service
from vision_core.clock import Instant, MonotonicClock
from vision_core.net.control import Attached, attach_to
from vision_core.timing.histogram import BINS, Counts, bin_of, quantile_s

PAGES = 20
CLIENTS_PER_TEAM = 5
RATE_HZ = 200.0
BLOCKS = 11
"""Of each kind: 22 000 frames."""
SETTLE_S = 2.0
"""At the beginning of each block, for pages to come or go; the tasks' records tell of the last half second."""
GOAL = 1.2
SHARES = {"p99": 0.99, "p99.9": 0.999}
DRAWS = 2000


@dataclass(frozen=True, slots=True)
class Block:
    """One stretch of time."""

    pages: int
    start: Instant
    end: Instant
    executions: dict[str, Counts]
    """Histograms of perceive's and serve's runs."""


Arm = dict[str, list[Counts]]
"""Histograms by what is measured, one for each block."""


def run(seconds: float = 10.0, blocks: int = BLOCKS) -> list[Row]:
    """Blocks of some seconds; blocks: of each kind."""
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="pslv-bench-")))
        shown = write_match(folder, RATE_HZ)
        path = stack.enter_context(configured(config_of(RATE_HZ)))
        service = stack.enter_context(running_service("--config", path, "--source", f"file:{folder}"))
        attached = attach_to(service.control)
        stack.callback(attached.close)
        wait_for_all(attached)
        done, reports = _measure(service, attached, seconds, blocks, stack)
        policies = policies_of(attached)
    stamps = reports["stamps"]
    arms = {pages: arm_of([block for block in done if block.pages == pages], stamps["stamps"]) for pages in (0, PAGES)}
    return [*_rows(arms[0], arms[PAGES]), *_notes(f"{shown}; {policies}", reports)]


def _measure(
    service: RunningService, attached: Attached, seconds: float, blocks: int, stack: contextlib.ExitStack
) -> tuple[list[Block], dict[str, Report]]:
    """Every block, and what stood beside them found."""
    arguments = {
        "receiver": (service.udp_port, CLIENTS_PER_TEAM),
        "stamps": (service.control, *WAY),
        "pages": (service.http,),
    }
    beside = {name: stack.enter_context(Companion(f"bench.{name}", *given)) for name, given in arguments.items()}
    done = []
    for number in range(2 * blocks):
        pages = PAGES * ((number + number // 2) % 2)  # none, 20, 20, none: a drift weighs on both alike
        beside["pages"].tell(str(pages))
        sit_out(SETTLE_S, "dashboards: settling")
        done.append(_block(attached, pages, seconds, f"dashboards: block {number + 1} of {2 * blocks}"))
    return done, {name: one.finish() for name, one in beside.items()}


def _block(attached: Attached, pages: int, seconds: float, what: str) -> Block:
    clock = MonotonicClock()
    start, before = clock.now(), histograms_of(attached, "execution")
    sit_out(seconds, what)
    end, after = clock.now(), histograms_of(attached, "execution")
    return Block(pages, start, end, {task: after[task] - before[task] for task in before})


def arm_of(blocks: list[Block], stamps: dict[str, list[Stamp]]) -> Arm:
    """What was measured in some blocks. stamps: measured and written, by record [ns]."""
    published = dict(stamps[FRAMES])
    ways = {"frame published -> seen": SIGHTINGS, "frame published -> last datagram sent": VIEWS}
    arm: Arm = {}
    for name, record in ways.items():
        took = [(at, at - published[measured]) for measured, at in stamps[record] if measured in published]
        arm[name] = [counted([ns for at, ns in took if block.start <= at < block.end]) for block in blocks]
    for task in WORKERS:
        arm[f"execution of {task}"] = [block.executions[task] for block in blocks]
    return arm


def counted(durations_ns: list[int]) -> Counts:
    """Their histogram."""
    return np.bincount([bin_of(duration) for duration in durations_ns], minlength=BINS).astype(np.uint64)


def ratio_interval(with_pages: list[Counts], without: list[Counts], share: float) -> tuple[float, float]:
    """95 % of the ratios of two quantiles, when blocks are drawn anew with replacement."""
    generator, ratios = np.random.default_rng(1), []
    for _ in range(DRAWS):
        drawn = [
            quantile_s(np.sum([arm[k] for k in generator.integers(len(arm), size=len(arm))], axis=0), share) or np.nan
            for arm in (with_pages, without)
        ]
        ratios.append(drawn[0] / drawn[1])
    low, high = np.nanquantile(ratios, [0.025, 0.975])
    return float(low), float(high)


def _rows(without: Arm, with_pages: Arm) -> list[Row]:
    rows: list[Row] = []
    for name, blocks in with_pages.items():
        for word, share in SHARES.items():
            rows += _ratio(f"{name}, {word}", blocks, without[name], share)
        frames = [int(np.sum(arm[name])) for arm in (with_pages, without)]
        rows.append({"name": f"{name}: frames", "value": frames[0], "twin": frames[1]})
    return rows


def _ratio(name: str, with_pages: list[Counts], without: list[Counts], share: float) -> list[Row]:
    """With pages over without, and the ratio's interval."""
    ours, alone = (quantile_s(np.sum(arm, axis=0), share) or np.nan for arm in (with_pages, without))
    low, high = ratio_interval(with_pages, without, share)
    row: Row = {
        "name": f"{name}: with {PAGES} pages, twin without (ratio {low:.2f} to {high:.2f})",
        "value": ours * US_PER_S,
        "unit": "us",
        "twin": alone * US_PER_S,
        "ratio": ours / alone,
    }
    return [row | ({"goal": f"<= {GOAL}x", "met": ours <= GOAL * alone} if share == SHARES["p99"] else {})]


def _notes(shown: str, reports: dict[str, Report]) -> list[Row]:
    """What there was."""
    pages, heard, stamps = reports["pages"], reports["receiver"], reports["stamps"]
    return [
        {"name": "most pages at once", "value": pages["most"]},
        {"name": "messages to pages", "value": pages["messages"]},
        {"name": "megabytes to pages", "value": round(pages["bytes"] / 1e6, 1)},
        {"name": "pages that were closed by the service", "value": len(pages["troubles"])},
        {"name": "stamps lost", "value": sum(stamps["lost"].values())},
        {"name": f"{heard['clients']} clients ({heard['policy']}), stamps ({stamps['policy']}); {shown}"},
    ]
