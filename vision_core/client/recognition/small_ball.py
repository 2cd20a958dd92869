"""A ball that is too small in the picture to fill a pixel: found by its share of the light of pixels.

Light adds up: a pixel at a border shows the mean of what lies on both sides. What lies before the nearest edge beside
the ball is floor, in any light, and white lines. One weighted sum of blue, green and red is 0 for all mixes of those,
and 1 for the ball (linear unmixing). Summed over a window it is the area of the ball that shows, in pixels.
"""

import cmath
import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vision_core.client.recognition.ball import as_told, grown, polar_of
from vision_core.client.recognition.edges import GOAL_OF_ROBOT, LETTERS, OBSTACLE, ROBOT
from vision_core.client.recognition.geometry import PictureGeometry
from vision_core.client.recognition.palette import Palette, Surface
from vision_core.client.recognition.rim import SIGMAS_OF_MEDIAN
from vision_core.geometry import Bytes, Floats, frozen
from vision_core.protocol.messages import HIDDEN, Ball

MIN_AREA_PX = 0.5
"""Smallest part of a ball [px of the picture]."""
MIN_SHARE = 0.12
"""Least share of the ball in its brightest pixel."""
NOISE_SIGMAS = 8.0
"""In a noisy picture the least share is so many times the noise of the floor's."""
WINDOW_PX = 2
"""The ball reaches so far from its brightest pixel, with its blur."""
BLUR_PX = 1
"""Of what is not floor, so much is mixed into the pixels beside it."""
BEHIND_PX = 2.5
"""The ball rises so far over the foot of what stands close behind it [px of equation 1]."""
MAX_LIKENESS = 0.1
"""Something of a larger share of the ball's color hides a small ball before it."""
MIN_INDEPENDENT = 0.2
"""Sine of the angle between the ball's color and the plane of floor and white: with less nothing can be told apart."""


def find_small_ball(
    picture: Bytes, letters: NDArray[np.str_], edges_px: Floats, geometry: PictureGeometry, palette: Palette
) -> Ball:
    """The place before the nearest edges with the most of the ball's light; HIDDEN when there is none.

    picture: blue green red, shape (height, width, 3); letters, edges_px: type and radius [px of equation 1, inf:
    nothing] of the nearest edge of evenly spaced directions, shape (n,).
    """
    weights = _weights(palette)
    if weights is None:
        return HIDDEN
    share = picture @ weights
    radius, direction = (each.reshape(share.shape) for each in polar_of(geometry))
    place = direction * (len(edges_px) / 360.0)
    between = [whole.astype(np.intp) % len(edges_px) for whole in (np.floor(place), np.ceil(place))]
    like_ball_px = np.where(np.isin(letters, _letters_like_ball(palette, weights)), edges_px, np.inf)
    hiding = radius >= np.minimum(*(like_ball_px[sector] for sector in between))
    end_px = np.minimum(*(edges_px[sector] for sector in between))
    searched = (radius > geometry.nearest_px) & (radius < geometry.farthest_px) & ~grown(hiding, BLUR_PX)
    floor = searched & (radius < end_px)
    searched &= radius < end_px + BEHIND_PX
    if not floor.any():
        return HIDDEN
    level = float(np.median(share[floor]))
    noise = SIGMAS_OF_MEDIAN * float(np.median(np.abs(share[floor] - level)))
    share = np.where(searched, share - level, 0.0)
    row, column = np.unravel_index(int(share.argmax()), share.shape)
    if share[row, column] < max(MIN_SHARE, NOISE_SIGMAS * noise):
        return HIDDEN
    window = tuple(slice(max(int(at) - WINDOW_PX, 0), int(at) + WINDOW_PX + 1) for at in (row, column))
    part = np.maximum(share[window], 0.0)
    area = float(part.sum())
    if area < MIN_AREA_PX:
        return HIDDEN
    center = complex((part * radius[window] * np.exp(1j * np.radians(direction[window]))).sum() / area)
    half_px = math.sqrt(area / math.pi) / geometry.scale
    return as_told(abs(center), math.degrees(cmath.phase(center)), half_px, geometry)


def _letters_like_ball(palette: Palette, weights: Floats) -> list[str]:
    """Types of edges whose surfaces look like a part of the ball, or of which nobody knows what they look like."""
    like = {surface for surface, rgb in palette.colors if np.array(rgb[::-1]) @ weights > MAX_LIKENESS}
    letters = {letter for surface, letter in LETTERS.items() if surface in like}
    goals = {goal for robot, goal in GOAL_OF_ROBOT.items() if robot in letters}  # they are painted in the same color
    return sorted(letters | goals | {ROBOT, OBSTACLE})


@lru_cache(maxsize=8)
def _weights(palette: Palette) -> Floats | None:
    """Of blue, green and red: their sum is 0 for the floor, at most that for what is white, and 1 for the ball.

    Of the sums that are 0 for one of the references of Surface.WALL, the one that is lowest for all of them. None if
    floor, wall and ball are not three different colors.
    """
    colors = {surface: _bgr_of(palette, surface) for surface in (Surface.FLOOR, Surface.WALL, Surface.BALL)}
    if not all(map(len, colors.values())):
        return None
    ball, sums = colors[Surface.BALL][0], []
    for wall in colors[Surface.WALL]:
        across = np.cross(colors[Surface.FLOOR][0], wall)
        amount = float(across @ ball)
        if abs(amount) > MIN_INDEPENDENT * float(np.linalg.norm(across) * np.linalg.norm(ball)):
            sums.append(across / amount)
    return frozen(min(sums, key=lambda weights: float((colors[Surface.WALL] @ weights).max()))) if sums else None


def _bgr_of(palette: Palette, surface: Surface) -> Floats:
    """The reference colors of a surface, shape (n, 3)."""
    return np.array([rgb[::-1] for each, rgb in palette.colors if each is surface], dtype=np.float64)
