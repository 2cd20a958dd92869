"""How much twenty open web pages delay the robots' views, at 200 Hz.

Setup: the running service shows a folder of pictures at 200 Hz to ten connected clients. Blocks of 10 s with 20 open
pages and blocks without take turns, so that both see the same drift of the machine. The baseline is the same service
without pages.

Measured [us], as p99 and p99.9 over all frames: from publishing a frame until its sightings are written, and until its
last datagram is sent (timestamps in the database, read by ``record_timestamps``); and how long the runs of perceive and
serve take (the tasks' own histograms). A ratio of 1 means that pages cost nothing; the goal is 1.2 for p99. The range
beside a ratio is its 95 % interval, from drawing blocks again with replacement (bootstrap). The histograms' bins are
3 % wide and interpolated (``vision_core.timing.histogram``).
"""

import contextlib
from dataclasses import dataclass

import numpy as np

from bench.frame_path import FRAME_PATH, FRAMES, SIGHTINGS, VIEWS, histograms_of, policies_of
from bench.helpers import Helper, Report, wait_with_progress
from bench.pictures import match_service
from bench.record_timestamps import Timestamps
from bench.runner import Row
from bench.service import RunningService
from vision_core.clock import US_PER_S, Instant, MonotonicClock
from vision_core.net.control import Attached
from vision_core.timing.histogram import BINS, Counts, bin_of, quantile_s

PAGES = 20
CLIENTS_PER_TEAM = 5
RATE_HZ = 200.0
BLOCKS = 11
"""Of each kind: 22 000 frames."""
SETTLE_S = 2.0
"""At the beginning of each block: pages open or close, and the tasks write their histograms twice a second."""
GOAL = 1.2
SHARES = {"p99": 0.99, "p99.9": 0.999}
DRAWS = 2000


@dataclass(frozen=True, slots=True)
class Block:
    """One stretch of time with a number of open pages."""

    pages: int
    start: Instant
    end: Instant
    executions: dict[str, Counts]
    """By task: histogram of the durations of its runs."""


Arm = dict[str, list[Counts]]
"""All blocks of one kind: by what is measured, one histogram for each block."""


def run(seconds: float = 10.0, blocks: int = BLOCKS) -> list[Row]:
    """seconds: length of a block; blocks: how many of each kind."""
    with contextlib.ExitStack() as stack:
        service, attached, description = stack.enter_context(match_service(RATE_HZ))
        done, reports = _measure(service, attached, seconds, blocks, stack)
        policies = policies_of(attached)
    timestamps = reports["record_timestamps"]["timestamps"]
    arms = {pages: arm_of([block for block in done if block.pages == pages], timestamps) for pages in (0, PAGES)}
    return [*_rows(arms[0], arms[PAGES]), *_notes(f"{description}; {policies}", reports)]


def _measure(
    service: RunningService, attached: Attached, seconds: float, blocks: int, stack: contextlib.ExitStack
) -> tuple[list[Block], dict[str, Report]]:
    """All blocks, and the reports of the helpers by module."""
    arguments = {
        "receiver": (service.udp_port, CLIENTS_PER_TEAM),
        "record_timestamps": (service.control, *FRAME_PATH),
        "pages": (service.http, service.token),
    }
    helpers = {name: stack.enter_context(Helper(f"bench.{name}", *given)) for name, given in arguments.items()}
    done = []
    for number in range(2 * blocks):
        pages = PAGES * ((number + number // 2) % 2)  # none, 20, 20, none: a drift affects both kinds alike
        helpers["pages"].send_line(str(pages))
        wait_with_progress(SETTLE_S, "dashboards: settling")
        done.append(_block(attached, pages, seconds, f"dashboards: block {number + 1} of {2 * blocks}"))
    return done, {name: helper.finish() for name, helper in helpers.items()}


def _block(attached: Attached, pages: int, seconds: float, label: str) -> Block:
    clock = MonotonicClock()
    start, before = clock.now(), histograms_of(attached, "execution")
    wait_with_progress(seconds, label)
    end, after = clock.now(), histograms_of(attached, "execution")
    return Block(pages, start, end, {task: after[task] - before[task] for task in before})


def arm_of(blocks: list[Block], timestamps: dict[str, list[Timestamps]]) -> Arm:
    """Histograms of everything measured, one for each block. timestamps: of all writes [ns], by record."""
    published = dict(timestamps[FRAMES])
    ends = {"frame published -> sightings written": SIGHTINGS, "frame published -> last datagram sent": VIEWS}
    arm: Arm = {}
    for name, record in ends.items():
        took = [(at, at - published[measured]) for measured, at in timestamps[record] if measured in published]
        arm[name] = [histogram_of([ns for at, ns in took if block.start <= at < block.end]) for block in blocks]
    for task in blocks[0].executions:
        arm[f"execution of {task}"] = [block.executions[task] for block in blocks]
    return arm


def histogram_of(durations_ns: list[int]) -> Counts:
    """Histogram of durations, in the bins of ``vision_core.timing.histogram``."""
    return np.bincount([bin_of(duration) for duration in durations_ns], minlength=BINS).astype(np.uint64)


def ratio_interval(with_pages: list[Counts], without: list[Counts], share: float) -> tuple[float, float]:
    """95 % interval of the ratio of two quantiles, from drawing blocks with replacement (bootstrap). share: 0..1."""
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
        rows += [_ratio_row(f"{name}, {word}", blocks, without[name], share) for word, share in SHARES.items()]
        frames = [int(np.sum(arm[name])) for arm in (with_pages, without)]
        rows.append({"name": f"{name}: frames", "value": frames[0], "baseline": frames[1]})
    return rows


def _ratio_row(name: str, with_pages: list[Counts], without: list[Counts], share: float) -> Row:
    """A quantile with pages, the same without as its baseline, and the interval of their ratio."""
    loaded, unloaded = (quantile_s(np.sum(arm, axis=0), share) or np.nan for arm in (with_pages, without))
    low, high = ratio_interval(with_pages, without, share)
    row: Row = {
        "name": f"{name}: with {PAGES} pages, baseline without (ratio {low:.2f} to {high:.2f})",
        "value": loaded * US_PER_S,
        "unit": "us",
        "baseline": unloaded * US_PER_S,
        "ratio": loaded / unloaded,
    }
    return row | ({"goal": f"<= {GOAL}x", "met": loaded <= GOAL * unloaded} if share == SHARES["p99"] else {})


def _notes(setup: str, reports: dict[str, Report]) -> list[Row]:
    """What the helpers counted, and the setup in words."""
    pages, receiver, timestamps = reports["pages"], reports["receiver"], reports["record_timestamps"]
    return [
        {"name": "most pages open at once", "value": pages["max_open"]},
        {"name": "messages to pages", "value": pages["messages"]},
        {"name": "megabytes to pages", "value": round(pages["bytes"] / 1e6, 1)},
        {"name": "pages closed by the service", "value": len(pages["errors"])},
        {"name": "timestamps missed", "value": sum(timestamps["missed"].values())},
        {"name": f"{receiver['clients']} clients ({receiver['policy']}), timestamps ({timestamps['policy']}); {setup}"},
    ]
