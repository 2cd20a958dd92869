"""What a side of the comparison reports: the edges of every direction, and the ball, as a client gets them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats
from vision_core.models.mirror import MAX_PX, MM_PER_M, Mirror
from vision_core.protocol.edge_codes import edge_codes
from vision_core.protocol.messages import Ball

Letters = NDArray[np.str_]

NOTHING = "-"
TEAM_LETTERS = edge_codes()["team"].view("S1").astype(np.str_)
"""By EdgeKind: what an on-board camera tells, the team and not the number; shape (256,)."""


@dataclass(frozen=True, slots=True)
class Report:
    """Edges in evenly spaced directions, anticlockwise, the first one straight ahead."""

    letters: Letters
    """Type of the nearest edge, shape (n,)."""
    radii_px: Floats
    """Its radius [px of equation 1], not cut to an integer; inf for nothing; shape (n,)."""
    ball: Ball

    @property
    def px(self) -> Floats:
        """R of equation 1: the integer part of the radii, at most 254; inf for nothing."""
        return np.where(np.isfinite(self.radii_px), np.minimum(np.floor(self.radii_px), MAX_PX), np.inf)


def report_of(kinds: Bytes, distances_mm: Floats, mirror: Mirror, ball: Ball) -> Report:
    """The report of edges on the floor. kinds: EdgeKind codes, shape (n,); distances: inf for nothing."""
    far = np.isfinite(distances_mm) & (kinds != 0)
    radii = mirror.px_from_mm(np.where(far, distances_mm, 0.0))
    return Report(np.where(far, TEAM_LETTERS[kinds], NOTHING), np.where(far, radii, np.inf), ball)


def millimetres(metres: Floats) -> Floats:
    """Distances [mm]."""
    return metres * MM_PER_M
