"""The paper's figures 3 and 5 to 8 in one picture: one loop against tasks."""

import math
from typing import TypeAlias

import numpy as np

from bench.cambada.paper import TASKS
from bench.cambada.results import Loop, Modular, execution_ms, intervals_ms, spread_of
from bench.charts import BLUE, ORANGE, Panel, Series, counts_of, draw_panels
from vision_core.geometry import Bytes, Floats
from vision_core.native.opencv import Color

Named: TypeAlias = tuple[str, Floats, Color]
"""A series, its values [ms] and its color."""

PANEL_PX = 800, 400
BINS = 40
MOST = 99.0
"""Percent of all values that bins from 0 hold apart."""
NICE_MS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Widths of bins."""
FIGURES = {"avoid_om": "6, left", "avoid_fr": "6, right", "ball_om": "7, left", "ball_fr": "7, right"} | {
    "kgoal": "8, left",
    "ypost": "8, right",
}
"""Where the paper shows a task's intervals."""


def draw(ordinary: Loop, privileged: Loop, modular: Modular, title: str) -> Bytes:
    """All figures; ordinary: the loop without real-time priority, as the paper's was."""
    ball = modular.tasks["ball_om"]
    trackers: list[Named] = [
        (f"in one loop, {ordinary.policy}", execution_ms(ordinary.ball), ORANGE),
        (f"as a task, {_policy(modular, 'ball_om')}, with its copy of the image", execution_ms(ball), BLUE),
    ]
    loops: list[Named] = [
        (f"one loop, {ordinary.policy}", intervals_ms(ordinary.runs), ORANGE),
        (f"the same, {privileged.policy}", intervals_ms(privileged.runs), BLUE),
    ]
    panels = [
        _from_nothing("Figure 3: execution time of the ball's tracker", "execution time", trackers),
        _from_nothing("Figure 5: activation interval of one loop for everything", "interval", loops),
        *(_round_period(name, ordinary, modular) for name in FIGURES),
    ]
    return draw_panels(panels, title, 2, PANEL_PX)


def _policy(modular: Modular, name: str) -> str:
    """That a task has got, without the reason."""
    return modular.policies[name].partition(" (")[0]


def _from_nothing(title: str, measured: str, named: list[Named]) -> Panel:
    """Bins from 0, which hold nearly all."""
    most = max(float(np.percentile(values, MOST)) for _, values, _ in named)
    width = next((nice for nice in NICE_MS if most / nice < BINS - 1), NICE_MS[-1])
    edges = (np.arange(BINS) * width).round(6).tolist()
    return _panel(title, f"{measured} [ms]; the last bin holds all that took longer", named, (*edges, math.inf))


def _round_period(name: str, ordinary: Loop, modular: Modular) -> Panel:
    """A task's intervals, and the loop's, on a scale that holds all of the task's."""
    period_ms, intervals = TASKS[name].period_ms, intervals_ms(modular.tasks[name])
    most = float(np.abs(intervals - period_ms).max())
    width = next((nice for nice in NICE_MS if most / nice < BINS / 2), NICE_MS[-1])
    edges = tuple((period_ms + (np.arange(BINS + 1) - BINS / 2) * width).round(6).tolist())
    named: list[Named] = [
        (f"in one loop, {ordinary.policy}, at every frame", intervals_ms(ordinary.runs), ORANGE),
        (f"as a task, {_policy(modular, name)}", intervals, BLUE),
    ]
    title = f"Figure {FIGURES[name]}: activation interval of {name}, every {period_ms:g} ms"
    return _panel(title, "interval [ms]; the outer bins hold all that lies beyond", named, edges)


def _panel(title: str, axis: str, named: list[Named], edges: tuple[float, ...]) -> Panel:
    series = tuple(Series(_legend(name, values), counts_of(values, edges), color) for name, values, color in named)
    return Panel(title, axis, edges, series, logarithmic=True, counted="how often, logarithmic")


def _legend(name: str, values: Floats) -> str:
    spread = spread_of(values)
    return f"{name}: {spread.min_ms:.2f} .. {spread.max_ms:.2f} ms, sd {spread.sd_ms:.2f} ms, n = {len(values)}"
