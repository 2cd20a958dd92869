"""The mirror's place in a picture: its round rim against the dark outside."""

from dataclasses import dataclass

import numpy as np

from vision_core.errors import SourceError
from vision_core.geometry import Bytes, Floats, Mask

CORNER_SHARE = 0.06
"""The outside is judged in the picture's corners, squares of so much of its shorter side."""
MAX_OUTSIDE = 70.0
"""Brighter corners, of 255, are no dark outside."""
CONTRAST = 25.0
"""Inside it is so much brighter."""
RUN_PX = 3
"""So many bright pixels in a row begin the inside: noise is shorter."""
ROUNDS = 12
MIN_TRIM_PX, TRIM_SIGMAS = 1.0, 2.5
"""Points farther from the circle are left out of the next fit."""
SIGMAS_OF_MEDIAN = 1.4826
MIN_SHARE = 0.4
"""Of the points, that must lie on the circle."""
ACCEPTED = f"a color picture of at least {RUN_PX}x{RUN_PX} px"
GIVE_IT = "a round mirror before a dark outside, or its center and rim given: --center X Y --rim PX"


@dataclass(frozen=True, slots=True)
class Rim:
    """The circle of a mirror's rim [px of the picture]."""

    column: float
    row: float
    radius_px: float


def find_rim(picture: Bytes) -> Rim:
    """The mirror's rim, by a trimmed fit of a circle to where each row and column becomes bright.

    picture: blue green red, shape (height, width, 3). The rim may be cut by the picture's border, or covered in part
    by something dark. Raises SourceError when the corners are not dark or there is no circle.
    """
    if picture.ndim != 3 or picture.shape[2] != 3 or min(picture.shape[:2]) < RUN_PX:
        raise SourceError("the mirror's rim", found=f"an array of shape {picture.shape}", accepted=ACCEPTED)
    light = picture.max(axis=2).astype(np.float64)
    side = max(int(CORNER_SHARE * min(light.shape)), 1)
    corners = [light[rows, columns] for rows in (slice(side), slice(-side, None)) for columns in _ends(side)]
    outside = float(np.median(np.concatenate([corner.reshape(-1) for corner in corners])))
    if outside > MAX_OUTSIDE:
        found = f"corners of brightness {outside:.0f} of 255"
        raise SourceError("the mirror's rim", found=found, accepted=GIVE_IT)
    inside = light > outside + CONTRAST
    points = np.concatenate([_borders(inside), _borders(inside.T)[:, ::-1]])
    if len(points) < 2 * RUN_PX:
        raise SourceError("the mirror's rim", found="a picture that is dark all over", accepted=GIVE_IT)
    rim, share = _fit(points)
    if share < MIN_SHARE or not 0.1 < 2.0 * rim.radius_px / min(light.shape) < 2.0:
        found = f"no circle: the best one has {100 * share:.0f} % of the border between dark and bright"
        raise SourceError("the mirror's rim", found=found, accepted=GIVE_IT)
    return rim


def _ends(side: int) -> tuple[slice, slice]:
    return slice(side), slice(-side, None)


def _borders(inside: Mask) -> Floats:
    """Column and row where each row's bright part begins and ends, shape (n, 2); none at the picture's border."""
    width = inside.shape[1]
    runs = np.all([inside[:, k : width - RUN_PX + 1 + k] for k in range(RUN_PX)], axis=0)
    rows = np.flatnonzero(runs.any(axis=1))
    first = runs[rows].argmax(axis=1)
    last = width - 1 - runs[rows][:, ::-1].argmax(axis=1)
    begins = np.column_stack([first - 0.5, rows])[first > 0]
    ends = np.column_stack([last + 0.5, rows])[last < width - 1]
    return np.concatenate([begins, ends]).astype(np.float64)


def _fit(points: Floats) -> tuple[Rim, float]:
    """The circle x^2 + y^2 = 2 a x + 2 b y + c by least squares, and the share of the points that it keeps."""
    kept = np.ones(len(points), dtype=np.bool_)
    middle = points.mean(axis=0)
    rim = Rim(0.0, 0.0, 0.0)
    for _ in range(ROUNDS):
        x, y = (points[kept] - middle).T
        (a, b, c), *_ = np.linalg.lstsq(np.column_stack([2.0 * x, 2.0 * y, np.ones(len(x))]), x * x + y * y, rcond=None)
        rim = Rim(float(middle[0] + a), float(middle[1] + b), float(np.sqrt(max(c + a * a + b * b, 0.0))))
        away = np.hypot(points[:, 0] - rim.column, points[:, 1] - rim.row) - rim.radius_px
        spread = SIGMAS_OF_MEDIAN * float(np.median(np.abs(away)))
        close = np.abs(away) <= max(TRIM_SIGMAS * spread, MIN_TRIM_PX)
        if close.sum() < 2 * RUN_PX or (close == kept).all():
            break
        kept = close
    return rim, float(np.mean(np.abs(away) <= 2.0 * MIN_TRIM_PX))
