"""Draws the paper's figures 3 and 5 to 8 into one picture: histograms of one loop against tasks."""

import math
from typing import TypeAlias

import numpy as np

from app.web.charts.panels import BLUE, ORANGE, Panel, Series, counts_of, draw_panels
from bench.cambada.paper import TASKS
from bench.cambada.results import Loop, Modular, execution_ms, intervals_ms, spread_of
from vision_core.geometry import Bytes, Floats
from vision_core.native.opencv import Color

DataSet: TypeAlias = tuple[str, Floats, Color]
"""Name, values [ms] and color."""

PANEL_PX = 800, 400
BINS = 40
COVERED_PERCENT = 99.0
"""Percent of all values that lie below the last bin, where bins begin at 0."""
BIN_WIDTHS_MS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Allowed widths of a bin."""
FIGURES = {"avoid_om": "6, left", "avoid_fr": "6, right", "ball_om": "7, left", "ball_fr": "7, right"} | {
    "kgoal": "8, left",
    "ypost": "8, right",
}
"""By task: the paper's figure of its intervals."""


def draw(ordinary: Loop, privileged: Loop, modular: Modular, title: str) -> Bytes:
    """All figures. ordinary: the loop without real-time priority, as the paper's was.

    Returns shape (height, width, 3), channels blue, green, red.
    """
    ball = modular.tasks["ball_om"]
    trackers: list[DataSet] = [
        (f"in one loop, {ordinary.policy}", execution_ms(ordinary.ball), ORANGE),
        (f"as a task, {_policy(modular, 'ball_om')}, with its copy of the image", execution_ms(ball), BLUE),
    ]
    loops: list[DataSet] = [
        (f"one loop, {ordinary.policy}", intervals_ms(ordinary.runs), ORANGE),
        (f"the same, {privileged.policy}", intervals_ms(privileged.runs), BLUE),
    ]
    panels = [
        _panel_from_zero("Figure 3: execution time of the ball's tracker", "execution time", trackers),
        _panel_from_zero("Figure 5: activation interval of one loop for everything", "interval", loops),
        *(_panel_around_period(name, ordinary, modular) for name in FIGURES),
    ]
    return draw_panels(panels, title, 2, PANEL_PX)


def _policy(modular: Modular, name: str) -> str:
    """The policy that a task was granted, without the reason."""
    return modular.policies[name].partition(" (")[0]


def _panel_from_zero(title: str, measured: str, data_sets: list[DataSet]) -> Panel:
    """A panel whose bins begin at 0; the last one holds the rest."""
    maximum = max(float(np.percentile(values, COVERED_PERCENT)) for _, values, _ in data_sets)
    width = next((width for width in BIN_WIDTHS_MS if maximum / width < BINS - 1), BIN_WIDTHS_MS[-1])
    edges = (np.arange(BINS) * width).round(6).tolist()
    return _panel(title, f"{measured} [ms]; the last bin holds all that took longer", data_sets, (*edges, math.inf))


def _panel_around_period(name: str, ordinary: Loop, modular: Modular) -> Panel:
    """The intervals of a task and of the loop; the bins are centered on the period and cover all of the task's."""
    period_ms, intervals = TASKS[name].period_ms, intervals_ms(modular.tasks[name])
    maximum = float(np.abs(intervals - period_ms).max())
    width = next((width for width in BIN_WIDTHS_MS if maximum / width < BINS / 2), BIN_WIDTHS_MS[-1])
    edges = tuple((period_ms + (np.arange(BINS + 1) - BINS / 2) * width).round(6).tolist())
    data_sets: list[DataSet] = [
        (f"in one loop, {ordinary.policy}, at every frame", intervals_ms(ordinary.runs), ORANGE),
        (f"as a task, {_policy(modular, name)}", intervals, BLUE),
    ]
    title = f"Figure {FIGURES[name]}: activation interval of {name}, every {period_ms:g} ms"
    return _panel(title, "interval [ms]; the outer bins hold all beyond", data_sets, edges)


def _panel(title: str, axis: str, data_sets: list[DataSet], edges: tuple[float, ...]) -> Panel:
    series = tuple(Series(_legend(name, values), counts_of(values, edges), color) for name, values, color in data_sets)
    return Panel(title, axis, edges, series, logarithmic=True, counted="count, logarithmic")


def _legend(name: str, values: Floats) -> str:
    spread = spread_of(values)
    return f"{name}: {spread.min_ms:.2f} .. {spread.max_ms:.2f} ms, sd {spread.sd_ms:.2f} ms, n = {len(values)}"
