"""Room that finding robots needs, taken once, and the limits it keeps to."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats
from vision_core.objects.circle_fit import center_memory
from vision_core.objects.robots.shapes import SHAPE_LENGTH
from vision_core.types.tables import MAX_ROBOTS, ROBOT, Table

MAX_SLOTS = 8

SCORE, TEAM, ANCHOR, X, Y, HEADING, MATCHED, SHAPED, STEADY, ROOM, MISFIT, FIRST_SLOT = range(12)
"""Columns of a hypothesis: its score 0..1, the number of its team, its anchor blob, its pose [m, rad], how many slots
it fills, whether the anchor's shape is known (2: and alone tells the heading), how firmly that does [m], radius of the
room that it takes [m], the sum of squared residuals in squared tolerances, then for each slot the blob there, -1 for
none."""
ROW_LENGTH = FIRST_SLOT + MAX_SLOTS

MAX_ROWS = 4096
"""Hypotheses of a frame; a frame of robots has two hundred."""

BUCKETS = 64
"""Of the grid of blobs, per axis."""

MAX_NEAR = 24
"""Blobs looked at round one anchor; a real robot has as many as its pattern."""

BLOB, ALONG, ACROSS, FIRST_LIKENESS = range(4)
"""Columns of a blob near an anchor: its number, its place from there [m], and how like each slot's patch it is, 0..1;
0: it is not."""


class Gates(NamedTuple):
    """What settings accept."""

    min_area: float
    max_area: float
    tolerance_m: float
    min_confidence: float
    center_floor_px: float
    edge_floor_px: float
    field_m: Floats
    """Half extents x, y of where robots may be, and of that with the goals, shape (4,)."""


class Memory(NamedTuple):
    """Filled anew for every frame."""

    places: Floats
    """x, y at marker height [m] and area [m^2] of blobs, for each team, shape (2, blobs, 3)."""
    listed: NDArray[np.int32]
    """Blobs that a team may wear, shape (blobs,)."""
    heads: NDArray[np.int32]
    """First blob of each cell of the grid, -1 for none; shape (64, 64)."""
    nexts: NDArray[np.int32]
    """The next blob of the same cell, shape (blobs,)."""
    near: Floats
    """Blobs round an anchor, columns as named above; shape (24, 11)."""
    filled: NDArray[np.int32]
    """The one of them that each slot has, -1 for none; shape (8,)."""
    shape: Floats
    """Of the anchor in question, shape (9,)."""
    rows: Floats
    """Shape (4096, 20), columns as named above."""
    order: NDArray[np.int32]
    """Rows, best first; shape (4096,)."""
    used: NDArray[np.bool_]
    """Blobs that a winner wears, shape (blobs,)."""
    winners: NDArray[np.int32]
    """Rows that won, shape (64,)."""
    ambiguous: NDArray[np.bool_]
    """Whether their headings are, shape (64,)."""
    centers: Floats
    """x, y [m], weight [1/m^2] of a winner's patches, the anchor's first; weight 0: there is none. Shape (9, 3)."""
    rim: Floats
    """What refining a center needs."""
    found: Table
    """Robots before they are put in order, shape (64,)."""


def take_memory(most_blobs: int) -> Memory:
    """Room for frames of so many blobs."""
    return Memory(
        places=np.zeros((2, most_blobs, 3)),
        listed=np.zeros(most_blobs, dtype=np.int32),
        heads=np.full((BUCKETS, BUCKETS), -1, dtype=np.int32),
        nexts=np.zeros(most_blobs, dtype=np.int32),
        near=np.zeros((MAX_NEAR, FIRST_LIKENESS + MAX_SLOTS)),
        filled=np.full(MAX_SLOTS, -1, dtype=np.int32),
        shape=np.zeros(SHAPE_LENGTH),
        rows=np.zeros((MAX_ROWS, ROW_LENGTH)),
        order=np.zeros(MAX_ROWS, dtype=np.int32),
        used=np.zeros(most_blobs, dtype=np.bool_),
        winners=np.zeros(MAX_ROBOTS, dtype=np.int32),
        ambiguous=np.zeros(MAX_ROBOTS, dtype=np.bool_),
        centers=np.zeros((1 + MAX_SLOTS, 3)),
        rim=center_memory(),
        found=np.zeros(MAX_ROBOTS, dtype=ROBOT),
    )
