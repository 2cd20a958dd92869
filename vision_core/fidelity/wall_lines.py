"""A white line that is painted at the foot of a white wall: what the on-board module sees begins with the line.

As with the height of the ball, a measure of the field that everybody knows is taken out before comparing: the
wall stands farther away by the width of the line, at a right angle to itself. Its direction is that of the points
that were seen beside it. No truth is used.
"""

from dataclasses import replace

import numpy as np

from vision_core.fidelity.reports import Report
from vision_core.geometry import Floats, Mask
from vision_core.models.mirror import Mirror

WALL = "w"
ASIDE = 3
"""The wall's direction is that between the points so many directions to the left and to the right."""
MAX_SLANT = 4.0
"""A wall that is seen at so flat an angle, as the ratio of both distances, is left as it was seen."""


def without_wall_lines(seen: Report, line_mm: float, mirror: Mirror) -> Report:
    """What was seen, with walls behind the line of a width that is painted at their feet."""
    mm = mirror.mm_from_px(seen.radii_px)
    wall = (seen.letters == WALL) & np.isfinite(mm)
    angles: Floats = np.arange(len(mm), dtype=np.float64) * (2.0 * np.pi / len(mm))
    distance = _distances_of_walls(np.where(wall, mm, 0.0), angles, wall)
    with np.errstate(divide="ignore", invalid="ignore"):
        corrected = mm * (1.0 + line_mm / distance)
    known = wall & (distance * MAX_SLANT > mm)
    radii = np.where(known, mirror.px_from_mm(np.where(known, corrected, 0.0)), seen.radii_px)
    return replace(seen, radii_px=radii)


def _distances_of_walls(mm: Floats, angles: Floats, wall: Mask) -> Floats:
    """Distance [mm] of the straight line through the neighbors of each direction; 0 where they show no wall."""
    x, y = mm * np.cos(angles), mm * np.sin(angles)
    left, right = (np.roll(np.arange(len(mm)), shift) for shift in (-ASIDE, ASIDE))
    dx, dy = x[left] - x[right], y[left] - y[right]
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.abs(x * dy - y * dx) / np.hypot(dx, dy)
    return np.where(wall & wall[left] & wall[right], away, 0.0)
