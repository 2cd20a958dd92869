"""Straight lines in a picture, in two families: those along the field and those across it, not yet which is which."""

import numpy as np

from vision_core.calibration.ridges import Ridges
from vision_core.geometry import Floats
from vision_core.native.opencv import straight_segments

MIN_SEGMENT, GAP_PX, VOTES = 0.04, 12.0, 25
"""Shortest segment as a share of the small picture's shorter side; gaps that it may have; votes of the transform."""
SAME_PX, SAME_DEG = 5.0, 4.0
"""Segments whose ends lie so near to a line of about its direction belong to it."""
FAMILY_DEG = 14.0
"""Perspective turns the lines of one family by up to so much against each other."""
MAX_LINES = 10
"""Of each family, the longest."""


def line_families(ridges: Ridges) -> tuple[Floats, Floats]:
    """Two families of lines, each as rows a, b, c with a x + b y + c = 0 in small pixels, shape (n, 3).

    The rows of a family are sorted by their place, and a, b is a unit vector that hardly differs within it.
    """
    shortest = MIN_SEGMENT * min(ridges.mask.shape)
    segments = straight_segments(ridges.thin, shortest, GAP_PX, VOTES)
    lines, lengths = _merged(segments)
    if not len(lines):
        return np.empty((0, 3)), np.empty((0, 3))
    angles = np.arctan2(lines[:, 1], lines[:, 0])
    tried = np.radians(np.arange(0.0, 90.0, 2.0))
    near = [np.abs(_off(angles, turn, np.pi / 2.0)) <= np.radians(FAMILY_DEG) for turn in tried]
    main = tried[int(np.argmax([lengths[mask].sum() for mask in near]))]
    families = []
    for turn in (main, main + np.pi / 2.0):
        own = np.flatnonzero(np.abs(_off(angles, turn, np.pi)) <= np.radians(FAMILY_DEG))
        own = own[np.argsort(-lengths[own])][:MAX_LINES]
        rows = lines[own]
        rows = rows * np.sign(rows[:, 0] * np.cos(turn) + rows[:, 1] * np.sin(turn))[:, None]
        center = np.array([ridges.mask.shape[1] / 2.0, ridges.mask.shape[0] / 2.0, 1.0])
        families.append(rows[np.argsort(-(rows @ center))])
    return families[0], families[1]


def _off(angles: Floats, turn: float, period: float) -> Floats:
    off: Floats = (angles - turn + period / 2.0) % period - period / 2.0
    return off


def _merged(segments: Floats) -> tuple[Floats, Floats]:
    """Lines through segments that lie on one, shape (n, 3), and the length of their segments [px], shape (n,)."""
    sizes = np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])
    groups: list[list[int]] = []
    lines: list[Floats] = []
    for i in np.argsort(-sizes).tolist():
        ends = segments[i].reshape(2, 2)
        along = (ends[1] - ends[0]) / max(sizes[i], 1e-9)
        for number, line in enumerate(lines):
            near = np.abs(ends @ line[:2] + line[2]).max() <= SAME_PX
            if near and abs(along @ line[:2]) <= np.sin(np.radians(SAME_DEG)):
                groups[number].append(i)
                lines[number] = _line_through(segments[groups[number]].reshape(-1, 2))
                break
        else:
            groups.append([i])
            lines.append(_line_through(ends))
    return np.array(lines).reshape(-1, 3), np.array([sizes[group].sum() for group in groups])


def _line_through(points: Floats) -> Floats:
    """The line a, b, c that points lie nearest to."""
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle)[2][1]
    return np.array([*normal, -(normal @ middle)])
