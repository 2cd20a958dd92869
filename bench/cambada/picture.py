"""The paper's figures 3 and 5 to 8 in one picture: one loop against tasks."""

import numpy as np

from bench.cambada.paper import TASKS
from bench.cambada.results import Loop, Modular, execution_ms, intervals_ms, spread_of
from bench.charts import BLUE, ORANGE, Panel, Series, counts_of, draw_panels
from vision_core.geometry import Bytes, Floats

PANEL_PX = 800, 400
BINS = 50
NICE_MS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""Widths of bins."""
FIGURES = {"avoid_om": "6, left", "avoid_fr": "6, right", "ball_om": "7, left", "ball_fr": "7, right"} | {
    "kgoal": "8, left",
    "ypost": "8, right",
}
"""Where the paper shows a task's intervals."""


def draw(ordinary: Loop, privileged: Loop, modular: Modular, title: str) -> Bytes:
    """All figures; ordinary: the loop without real-time priority, as the paper's was."""
    ball = [(f"in one loop, {ordinary.policy}", execution_ms(ordinary.ball), ORANGE)]
    ball.append(
        (
            f"as a task, {modular.policies['ball_om']}, its copy of the image included",
            execution_ms(modular.tasks["ball_om"]),
            BLUE,
        )
    )
    loops = [(f"one loop, {ordinary.policy}", intervals_ms(ordinary.runs), ORANGE)]
    loops.append((f"the same, {privileged.policy}", intervals_ms(privileged.runs), BLUE))
    panels = [
        _panel("Figure 3: execution time of the ball's tracker", "execution time [ms]", ball, 0.0),
        _panel("Figure 5: activation interval of one loop for everything", "interval [ms]", loops, None),
    ]
    for name, figure in FIGURES.items():
        period = TASKS[name].period_ms
        task = (f"as a task, {modular.policies[name]}", intervals_ms(modular.tasks[name]), BLUE)
        rival = (f"in one loop, {ordinary.policy}, every frame", intervals_ms(ordinary.runs), ORANGE)
        title_of = f"Figure {figure}: activation interval of {name}, every {period:g} ms"
        panels.append(_panel(title_of, "interval [ms]", [rival, task], None))
    return draw_panels(panels, title, 2, PANEL_PX)


def _panel(title: str, axis: str, named: list[tuple[str, Floats, tuple[int, int, int]]], low: float | None) -> Panel:
    """Series over bins that hold them all; low: where the first bin begins, None: where the values do."""
    everything = np.concatenate([values for _, values, _ in named])
    first = float(everything.min()) if low is None else low
    width = next((nice for nice in NICE_MS if (everything.max() - first) / nice < BINS), NICE_MS[-1])
    edges = tuple((np.arange(BINS + 1) * width + np.floor(first / width) * width).round(6).tolist())
    series = tuple(Series(_legend(name, values), counts_of(values, edges), color) for name, values, color in named)
    return Panel(title, axis, edges, series, logarithmic=True, counted="how often (logarithmic)")


def _legend(name: str, values: Floats) -> str:
    spread = spread_of(values)
    return f"{name}: {spread.min_ms:.2f} .. {spread.max_ms:.2f} ms, sd {spread.sd_ms:.2f} ms, n = {len(values)}"
