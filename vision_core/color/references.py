"""What each class looks like: the mean and the covariance of the chromaticities that a table gives to it."""

import numpy as np

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.types.colors import LUMA_BGR, References, chromaticity

MIN_SPREAD = 0.1
"""Least standard deviation of a paint's chromaticity: print, glare and noise."""
UNKNOWN_SPREAD = 2.0
"""Of a class without a color."""
PAPER_LUMA, PAPER_LUMA_SD = 130.0, 60.0
"""How light papers are in pictures: the cells of a class count by it."""


def references_of(classes: Bytes, cells: Floats, count: int) -> References:
    """The references of the classes of a table.

    classes: of each cell, shape (n,); cells: their colors, shape (n, 3); count: of the classes, with "no class".
    """
    if count == 1:
        return References(frozen(np.zeros((1, 2))), frozen(np.array([[UNKNOWN_SPREAD**2, 0.0, UNKNOWN_SPREAD**2]])))
    weights = np.exp(-0.5 * ((cells @ LUMA_BGR - PAPER_LUMA) / PAPER_LUMA_SD) ** 2)
    places = chromaticity(cells)
    means, spreads = np.zeros((count, 2)), np.zeros((count, 3))
    for number in range(count):
        own = classes == number
        spread = UNKNOWN_SPREAD**2 * np.eye(2)
        if number and own.any():
            means[number] = np.average(places[own], axis=0, weights=weights[own])
            spread = np.cov(places[own].T, aweights=weights[own], bias=True) + MIN_SPREAD**2 * np.eye(2)
        spreads[number] = spread[0, 0], spread[0, 1], spread[1, 1]
    return References(frozen(means), frozen(spreads))
