"""A robot's own camera beside PSLV: do they see the same edges? Counted, and drawn."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.client.panorama import COLORS, UNDEFINED_COLOR, WIDTH_PX, draw_view
from vision_core.client.view import View
from vision_core.geometry import Bytes, Floats, Mask, frozen
from vision_core.models.mirror import Mirror
from vision_core.protocol.options import Options
from vision_core.types.edges import ANY_ROBOT, BLUE, EDGE_TYPES, YELLOW

NEIGHBORS = (-1, 0, 1)
"""Directions between which two edges count as the same place: a degree is half a pixel to two pixels."""
LINE_PX, STRIP_PX, PLOT_PX = 4, 12, 60
"""Heights in the drawing: a gap, a strip of types, the plot of distances."""
MAX_ERROR_PX = 10.0
"""Upper end of the plot."""
BACKGROUND, SAME, DIFFERENT, ERROR = (16, 18, 22), (46, 122, 66), (220, 60, 50), (238, 240, 244)


@dataclass(frozen=True, slots=True)
class Comparison:
    """How two views of the same instant differ. Arrays are read-only, one element per direction."""

    same_type: Mask
    """Whether the camera's edge is of a type that PSLV has within one direction, shape (n,)."""
    error_px: Floats
    """The camera's distance minus PSLV's, of three neighboring directions the nearest [px of equation 1]; nan where
    one of them has no edge; shape (n,)."""
    ball_px: float
    """The camera's distance of the ball minus PSLV's; nan when one of them does not see it."""

    @property
    def share(self) -> float:
        """The share of directions of the same type."""
        return float(self.same_type.mean())

    @property
    def median_px(self) -> float:
        """Median of the absolute errors of the distance [px]; nan without any."""
        return self._quantile(0.5)

    @property
    def p95_px(self) -> float:
        """95th percentile of the absolute errors of the distance [px]; nan without any."""
        return self._quantile(0.95)

    @property
    def sentence(self) -> str:
        """In one line, for people."""
        text = f"{100 * self.share:.1f} % of directions of the same type"
        text += f", distance off by {self.median_px:.1f} px (median), {self.p95_px:.1f} px (95 %)"
        return f"{text}, ball by {self.ball_px:+.0f} px" if np.isfinite(self.ball_px) else text

    def _quantile(self, share: float) -> float:
        known = np.abs(self.error_px[np.isfinite(self.error_px)])
        return float(np.quantile(known, share)) if len(known) else np.nan


def compare(camera: View, pslv: View) -> Comparison:
    """Compare what a camera's picture shows with PSLV's view. Raises ValueError unless the directions are the same."""
    if len(camera.px) != len(pslv.px) or not len(camera.px):
        raise ValueError(f"{len(camera.px)} and {len(pslv.px)} directions: the same number of at least one")
    seen, told = fold(camera.letters), fold(pslv.letters)
    any_team = ANY_ROBOT.default
    robots = (any_team, BLUE.default, YELLOW.default)
    same = np.zeros(len(seen), dtype=np.bool_)
    errors = np.full((len(NEIGHBORS), len(seen)), np.nan)
    for row, shift in enumerate(NEIGHBORS):
        near, px = np.roll(told, shift), np.roll(pslv.px, shift)
        unnamed = np.isin(near, robots) & np.isin(seen, robots) & ((near == any_team) | (seen == any_team))
        same |= (seen == near) | unnamed
        known = (camera.px >= 0) & (px >= 0)
        errors[row, known] = camera.px[known] - px[known].astype(np.float64)
    best = np.where(np.isnan(errors), np.inf, np.abs(errors)).argmin(axis=0)
    ball = np.nan if camera.ball.hidden or pslv.ball.hidden else float(camera.ball.px - pslv.ball.px)
    return Comparison(frozen(same), frozen(errors[best, np.arange(len(seen))]), ball)


def fold(letters: NDArray[np.str_]) -> NDArray[np.str_]:
    """What an on-board camera can tell: a robot's team, not its number."""
    folded = letters.copy()
    for edge in EDGE_TYPES:
        if edge.numbered is not None:
            first = ord(edge.numbered.default)
            numbered = [chr(first + number) for number in range(edge.numbered.count)]
            folded[np.isin(letters, numbered)] = edge.team.default
    return folded


def draw_comparison(camera: View, pslv: View, mirror: Mirror, options: Options) -> Bytes:
    """The camera's panorama on the left, PSLV's on the right; below, over all directions: red where the types differ,
    the types of both (the camera's above), and the absolute error of the distance. Red green blue.

    mirror, options: of PSLV's view; the camera's has the same directions.
    """
    comparison = compare(camera, pslv)
    width = 2 * WIDTH_PX
    panoramas = np.hstack([draw_view(view, mirror, options) for view in (camera, pslv)])
    column = np.arange(width) * len(camera.px) // width
    gap = np.full((LINE_PX, width, 3), BACKGROUND, dtype=np.uint8)
    verdict = np.where(comparison.same_type[:, None], SAME, DIFFERENT).astype(np.uint8)
    strips = [gap]
    for colors in (verdict, _colors_of(camera.letters), _colors_of(pslv.letters)):
        strips += [np.broadcast_to(colors[column], (STRIP_PX, width, 3)), gap]
    errors = np.nan_to_num(np.abs(comparison.error_px))[column]
    heights = np.minimum(errors / MAX_ERROR_PX, 1.0) * PLOT_PX
    filled = PLOT_PX - np.arange(PLOT_PX)[:, None] <= heights
    plot = np.where(filled[..., None], ERROR, BACKGROUND).astype(np.uint8)
    return np.vstack([panoramas, *strips, plot])


def _colors_of(letters: NDArray[np.str_]) -> Bytes:
    return np.array([COLORS.get(letter, UNDEFINED_COLOR) for letter in letters.tolist()], dtype=np.uint8)
