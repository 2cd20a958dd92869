"""Draws a mirror's calibration: the curve with its band over the pairs, and below it how far beside they lie."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vision_core.calibration.mirror.result import MirrorCalibration, PairResult
from vision_core.geometry import Bytes
from vision_core.native.opencv import Color, Point, draw_circle, draw_line, draw_text

WIDTH_PX, HEIGHT_PX = 800, 640
PLOT_TOP, PLOT_BOTTOM, REST_TOP, REST_BOTTOM, LEFT, RIGHT = 30, 380, 424, 530, 60, 780
BACKGROUND = 24
GRID: Color = (70, 70, 70)
WHITE: Color = (235, 235, 235)
CURVE: Color = (80, 255, 80)
BAND: Color = (60, 110, 60)
PAIR: Color = (0, 220, 255)
OUTLIER: Color = (255, 80, 255)
TEXT, STEP_PX, LINES, LINE_CHARACTERS = 0.42, 17, 5, 118
RULER_MM = 500.0
"""Between vertical lines; twice, four times as much where there would be many."""
MIN_REST_PX = 1.0
"""Least half height of the lower plot, in pixels of the on-board picture."""


@dataclass(frozen=True, slots=True)
class _Plot:
    """Where values lie in the picture."""

    x_range: tuple[float, float]
    y_range: tuple[float, float]
    top: int
    bottom: int

    def place(self, x: float, y: float) -> Point:
        """Of a point; outside of the plot it lies on its edge."""
        across = np.interp(x, self.x_range, (LEFT, RIGHT))
        return float(across), float(np.interp(y, self.y_range, (self.bottom, self.top)))


def draw_mirror(result: MirrorCalibration) -> Bytes:
    """A picture of a verdict, shape (640, 800, 3), channels blue, green, red."""
    canvas = np.full((HEIGHT_PX, WIDTH_PX, 3), BACKGROUND, dtype=np.uint8)
    farthest = 1.02 * max([2500.0, *(pair.r_mm for pair in result.pairs)])
    highest = max([20.0, *(point.r_px for point in result.curve), *(pair.r_px for pair in result.pairs if pair.counts)])
    curve = _Plot((0.0, farthest), (0.0, 1.1 * highest), PLOT_TOP, PLOT_BOTTOM)
    rest_px = max([MIN_REST_PX, *(1.3 * abs(pair.off_px or 0.0) for pair in result.pairs if pair.counts)])
    rest = _Plot((0.0, farthest), (-rest_px, rest_px), REST_TOP, REST_BOTTOM)
    _axes(canvas, curve, "R [px]")
    _axes(canvas, rest, "beside the curve [px]; r [mm]")
    for scale, plot in ((1.0, curve), (0.0, rest)):
        sides = [[(p.r_mm, scale * p.r_px + side * p.deviation_px) for p in result.curve] for side in (-2.0, 2.0, 0.0)]
        for points, color in zip(sides, (BAND, BAND, CURVE), strict=True):
            _path(canvas, plot, points, color)
    _points(canvas, curve, result.pairs, lambda pair: pair.r_px)
    _points(canvas, rest, [pair for pair in result.pairs if pair.off_px is not None], lambda pair: pair.off_px or 0.0)
    texts = [*result.words, *(reason.text for reason in result.reasons), *result.notes]
    lines = [text[:LINE_CHARACTERS].encode("ascii", "replace").decode() for text in texts]
    for number, line in enumerate(lines[:LINES]):
        draw_text(canvas, line, (10, REST_BOTTOM + 30 + number * STEP_PX), WHITE, TEXT)
    return canvas


def _axes(canvas: Bytes, plot: _Plot, name: str) -> None:
    low, high = plot.y_range
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        y = low + share * (high - low)
        at = plot.place(0.0, y)
        draw_line(canvas, at, (RIGHT, at[1]), GRID)
        draw_text(canvas, f"{y:.4g}", (8, at[1] + 4), WHITE, TEXT)
    step = RULER_MM * 2.0 ** max(np.ceil(np.log2(plot.x_range[1] / (10.0 * RULER_MM))), 0.0)
    for x in np.arange(0.0, plot.x_range[1], step).tolist():
        draw_line(canvas, plot.place(x, low), plot.place(x, high), GRID)
        draw_text(canvas, f"{x:.0f}", (plot.place(x, low)[0] - 14, plot.bottom + 16), WHITE, TEXT)
    draw_text(canvas, name, (LEFT + 4, plot.top - 6), WHITE, TEXT)


def _path(canvas: Bytes, plot: _Plot, points: Sequence[Point], color: Color) -> None:
    for start, end in pairwise(points):
        draw_line(canvas, plot.place(*start), plot.place(*end), color)


def _points(canvas: Bytes, plot: _Plot, pairs: Sequence[PairResult], height: Callable[[PairResult], float]) -> None:
    for pair in pairs:
        color = PAIR if pair.counts else OUTLIER
        draw_circle(canvas, plot.place(pair.r_mm, height(pair)), 3.0, color, -1 if pair.counts else 1)
