"""What each paint looks like: a class of the color table as a reference color with its spread.

Colors are compared by their chromaticity ``(log B/G, log R/G)``. Half the light leaves it as it is, and another color
of the light adds the same vector to every paint (von Kries), so that what differs between two papers of one marker
stays. A level is added to each channel first, since near black the ratios are noise.
"""

from typing import NamedTuple

import numpy as np

from vision_core.geometry import Floats, frozen
from vision_core.types.colors import CELL_COUNT, CELL_SIZE_BGR, LUMA_BGR, ColorTable, cell_corner

DARK_LEVEL = 24.0
"""Added to every channel [grey levels]."""
MIN_SPREAD = 0.1
"""Least standard deviation of a paint's chromaticity: print, glare and noise."""
UNKNOWN_SPREAD = 2.0
"""Of a class without a color."""
PAPER_LUMA, PAPER_LUMA_SD = 130.0, 60.0
"""How light papers are in pictures: the cells of a class count by it."""


class References(NamedTuple):
    """The paints of a color table. Kernels take it as one argument."""

    means: Floats
    """Chromaticity of every class, shape (classes, 2)."""
    spreads: Floats
    """Its covariance: xx, xy, yy; shape (classes, 3)."""


def chromaticity(bgr: Floats) -> Floats:
    """log B/G and log R/G: shape (n, 3) -> (n, 2)."""
    logs = np.log(bgr + DARK_LEVEL)
    return np.column_stack([logs[:, 0] - logs[:, 1], logs[:, 2] - logs[:, 1]])


def references_of(table: ColorTable) -> References:
    """Mean and covariance of the chromaticities that a table gives to each class."""
    corners = np.column_stack(cell_corner(np.arange(CELL_COUNT)))
    cells = corners + (np.array(CELL_SIZE_BGR) - 1) / 2.0
    weights = np.exp(-0.5 * ((cells @ LUMA_BGR - PAPER_LUMA) / PAPER_LUMA_SD) ** 2)
    places = chromaticity(cells)
    means, spreads = np.zeros((len(table.names), 2)), np.zeros((len(table.names), 3))
    for number in range(len(table.names)):
        own = table.classes == number
        spread = UNKNOWN_SPREAD**2 * np.eye(2)
        if own.any():
            means[number] = np.average(places[own], axis=0, weights=weights[own])
            spread = np.cov(places[own].T, aweights=weights[own], bias=True) + MIN_SPREAD**2 * np.eye(2)
        spreads[number] = spread[0, 0], spread[0, 1], spread[1, 1]
    return References(frozen(means), frozen(spreads))
