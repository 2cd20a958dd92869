"""Fidelity of the simulated view: what PSLV tells a robot against what its own camera would have shown it.

Random worlds on a 3 m field (on-board picture 320x240) and a league-size one (640x480), under a ceiling camera of
640x480 and of 1280x1024, with robots that the on-board camera looks over (150 mm) and robots as high as its viewpoint.
The view comes from the ceiling's picture, its counterpart from the rendered on-board picture; types are compared within
a direction. Every disagreement has a cause (``vision_core.fidelity``). The baselines of the errors in millimetres are
those of the on-board module in the same directions.

Whether the ball is hidden is compared with two on-board sides: our module, and an ideal camera of the same resolution,
which sees a ball of which at least a pixel shows, by the exact geometry of the scene. A ball is clear when it is hidden
or shows at least a pixel.

Then the paper's section 4.3: where a pixel of the on-board camera is as large as one of the ceiling's, and what is left
of narrower and finer views (no goal: where the simulation stops being true).
"""

import math
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise, product
from multiprocessing import get_context

from bench.runner import Row
from vision_core.fidelity.balls import BallCause
from vision_core.fidelity.causes import Cause
from vision_core.fidelity.experiment import RANGES_MM, Tally
from vision_core.fidelity.experiment import run as compare_worlds
from vision_core.fidelity.options import OptionRow, measure
from vision_core.fidelity.resolution import crossing_mm, mm_per_px_ceiling
from vision_core.fidelity.worlds import CEILING_PX, FIELDS, ONBOARD_PX, Setup

WORLDS = 12
"""Of each field and height, without --worlds."""
CHUNK = 50
"""So many worlds are compared by one process, with cameras of their own."""
FIRST_SEEDS = {key: 1_000_000 * number for number, key in enumerate(product(FIELDS, (False, True)), start=1)}
"""Every field and height has worlds of its own."""
MIN_TYPE, MIN_WITHIN, MIN_HIDDEN, MAX_UNEXPLAINED = 0.98, 0.95, 0.99, 0.005
MAX_OPTION_WORLDS = 200
PAPER_MM_PER_PX, PAPER_CROSSING_MM = 5.0, 220.0


def run(worlds: int = WORLDS) -> list[Row]:
    """Compare so many worlds of each field and height of robots, in as many processes as there are processors."""
    from app.commands.progress import Progress

    progress = Progress("fidelity")
    rows: list[Row] = []
    chunks = [
        (field, tall, seeds)
        for field, tall in product(FIELDS, (False, True))
        for seeds in batched_seeds(FIRST_SEEDS[field, tall], worlds)
    ]
    tallies: dict[tuple[str, bool, str], Tally] = {}
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for (field, tall, seeds), found in zip(chunks, pool.map(_compare, chunks), strict=True):
            progress.show(f"{field} field, {'high' if tall else 'low'} robots: to world {seeds[-1]}")
            for ceiling, tally in found.items():
                tallies.setdefault((field, tall, ceiling), Tally(tally.setup)).extend(tally)
    for (field, tall, ceiling), tally in tallies.items():
        name = f"{field}, {ceiling}, {'high' if tall else 'low'} robots"
        rows += [row | {"name": f"{name}: {row['name']}"} for row in tally_rows(tally)]
    progress.show("narrower and finer views")
    rows += [*crossing_rows(), *(option_row(row) for row in measure(range(min(worlds, MAX_OPTION_WORLDS))))]
    progress.show("")
    return rows


def batched_seeds(first: int, worlds: int) -> list[range]:
    """Seeds of so many worlds in parts of CHUNK: the figures do not depend on the number of processes."""
    return [range(at, min(at + CHUNK, first + worlds)) for at in range(first, first + worlds, CHUNK)]


def _compare(chunk: tuple[str, bool, range]) -> dict[str, Tally]:
    field, tall, seeds = chunk
    return compare_worlds(field, ONBOARD_PX[field], tall=tall, seeds=seeds, show=lambda _: None)


def tally_rows(tally: Tally) -> list[Row]:
    """What was counted of one setup."""
    rows: list[Row] = [
        {"name": "worlds compared", "value": len(tally.comparisons), "unit": f"of {tally.worlds}"},
    ]
    if not tally.comparisons:
        return rows
    rows += [
        _at_least("type alike", tally.share_of_type(), MIN_TYPE),
        _at_least("distance within 1 px", tally.share_within(1.0), MIN_WITHIN),
        {"name": "distance, p95", "value": tally.error_px(95.0), "unit": "px"},
    ]
    for cause in Cause:
        row: Row = {"name": cause.value, "value": round(tally.share_of(cause), 5)}
        if cause is Cause.UNEXPLAINED:
            row |= {"goal": f"< {MAX_UNEXPLAINED}", "met": tally.share_of(cause) < MAX_UNEXPLAINED}
        rows.append(row)
    for clear, ideal in product((False, True), (False, True)):
        alike, count = tally.hidden_agreement(clear=clear, ideal=ideal)
        ball, eye = "clear ball" if clear else "any ball", "ideal camera" if ideal else "on-board module"
        row = {"name": f"hidden or not alike, {ball}, {eye}", "value": round(alike / count, 4), "unit": f"of {count}"}
        has_goal = tally.setup.tall and clear
        rows.append(row | ({"goal": f">= {MIN_HIDDEN}", "met": alike >= MIN_HIDDEN * count} if has_goal else {}))
    causes = Counter(each.ball.cause for each in tally.comparisons)
    rows += [{"name": f"ball {cause.value}", "value": causes[cause], "unit": "worlds"} for cause in BallCause]
    for low, high in pairwise(RANGES_MM):
        rows += _range_rows(tally, low, high)
    return rows


def _range_rows(tally: Tally, low_mm: float, high_mm: float) -> list[Row]:
    """Errors and balls in a range: an on-board camera sees the near better, a ceiling camera does not."""
    name = f"{low_mm:.0f}..{high_mm:.0f} mm"
    ceiling, onboard = (tally.rms_mm(side, low_mm, high_mm) for side in ("ceiling_mm", "onboard_mm"))
    balls, seen, told = tally.balls_seen(low_mm, high_mm)
    rows: list[Row] = []
    if math.isfinite(ceiling) and math.isfinite(onboard):
        rows.append({"name": f"edges rms, {name}", "value": ceiling, "unit": "mm", "baseline": onboard})
    if balls:
        rows.append({"name": f"balls told, {name}", "value": told, "unit": f"of {balls}", "baseline": seen})
    return rows


def crossing_rows() -> list[Row]:
    """From where on the on-board camera is coarser than the ceiling's; first with the paper's 5 mm per pixel."""
    mirror = Setup("3 m", "640x480", ONBOARD_PX["3 m"], tall=False).mirror
    across, _ = crossing_mm(mirror, PAPER_MM_PER_PX)
    rows: list[Row] = [
        {"name": "pixels alike at, across, 5 mm/px", "value": across, "unit": "mm", "baseline": PAPER_CROSSING_MM,
         "ratio": across / PAPER_CROSSING_MM}
    ]  # fmt: skip
    for field, ceiling in product(FIELDS, CEILING_PX):
        setup = Setup(field, ceiling, ONBOARD_PX[field], tall=False)
        mm_per_px = mm_per_px_ceiling(setup.settings)
        for name, value in zip(("across", "along"), crossing_mm(setup.mirror, mm_per_px), strict=True):
            words = f"{field}, {ceiling} ({mm_per_px:.1f} mm/px): pixels alike at, {name}"
            rows.append({"name": words, "value": value if math.isfinite(value) else None, "unit": "mm"})
    return rows


def option_row(row: OptionRow) -> Row:
    """One row of the table of options: the share of directions that are told as exact poses would have them."""
    name = f"{row.field}, {row.ceiling}: {row.fov_deg:g} deg at {row.resolution_deg:g}, horizon {row.horizon_px:.0f} px"
    unit = f"type {row.same_type:.4f}, 1 px {row.within_px:.4f}"
    return {"name": f"{name}: told exactly", "value": row.equal, "unit": unit}


def _at_least(name: str, value: float, goal: float) -> Row:
    return {"name": name, "value": round(value, 5), "goal": f">= {goal}", "met": value >= goal}
