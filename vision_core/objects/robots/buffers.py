"""Memory that finding robots works in, allocated once, and the limits of its tables."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Floats, Mask
from vision_core.objects.circle_fit import circle_buffer
from vision_core.objects.robots.shapes import MEASURED_SHAPE
from vision_core.types.tables import MAX_ROBOTS, ROBOT, Table

MAX_SLOTS = 8
"""Patches of a marker beside the team's patch."""

MAX_HYPOTHESES = 4096
"""Per frame; a frame of robots has two hundred."""

GRID_CELLS = 64
"""Of the grid of blobs, per axis."""

MAX_NEIGHBORS = 24
"""Blobs round one anchor that are considered; a real robot has as many as its pattern."""

PATCH_COLUMNS = 10
"""What is measured of a robot's patch, see ``paint_residual``."""

NO_BLOB = -1

NO_SHAPE, SHAPE_MEASURED, HEADING_BY_SHAPE = range(3)
"""What the anchor's shape contributes to a hypothesis: nothing, a part of the score, or the heading by itself."""

HYPOTHESIS = np.dtype(
    [
        ("score", np.float64), ("x_m", np.float64), ("y_m", np.float64), ("heading_rad", np.float64),
        ("heading_stiffness_m", np.float64), ("exclusion_radius_m", np.float64), ("misfit", np.float64),
        ("explained_px", np.float64), ("team", np.int32), ("marker", np.int32), ("anchor", np.int32),
        ("matched", np.int32), ("shape_evidence", np.int32), ("slot_blobs", np.int32, (MAX_SLOTS,)),
        ("shapes", np.int8, (MAX_SLOTS,)), ("rival_shapes", np.int8, (MAX_SLOTS,)),
        ("shape_margins", np.float32, (MAX_SLOTS,)), ("shape_leans", np.float32, (MAX_SLOTS,)),
        ("shape_misfits", np.float32, (MAX_SLOTS,)),
    ]
)  # fmt: skip
"""A way to see a robot: score 0..1, pose, how firmly the anchor's shape holds the heading (``heading_sd``), radius in
which no other robot can stand, sum of the squared residuals over the squared tolerance, pixels that it explains (where
a team has several markers, see ``marker_weighing``), numbers of the team and of the marker, anchor blob, slots with a
blob, what the anchor's shape contributes, and the blob in each slot (NO_BLOB: none). Of a robot whose slots have one of
the code's shapes: the best one, the second best, and how sure that is (``shape_reading``)."""

NEIGHBOR = np.dtype(
    [("x_m", np.float64), ("y_m", np.float64), ("area_scores", np.float64, (MAX_SLOTS,)), ("blob", np.int64)]
)
"""A blob near an anchor: its place relative to the anchor, its area's score for each slot, 0..1 (0: it cannot fill the
slot), and its row in the table of blobs."""

PREDICTED = np.dtype(
    [
        *((name, np.float64) for name in ("ahead_x", "ahead_y", "left_x", "left_y", "px_m")),
        *((name, np.float64, (1 + MAX_SLOTS,)) for name in ("x_m", "y_m", "x_px", "y_px")),
    ]
)  # fmt: skip
"""Where a known robot should be in the picture: how far a metre ahead and one to its left reach, and one in any
direction on average [px/m], and the places of its patches on the plane of the markers [m] and in the picture [px]."""


class Gates(NamedTuple):
    """The limits of what is accepted, from the settings."""

    min_area: float
    """Of a patch, as a share of the area predicted."""
    max_area: float
    tolerance_m: float
    """Distance of a patch from its place in the fitted marker."""
    min_confidence: float
    circle_sd_px: float
    """Deviation of a refined circle's center that is never undercut."""
    polygon_sd_px: float
    """The same of a polygon's centroid."""
    extents_m: Floats
    """Where robots are accepted, see ``field_limits``; shape (4,)."""


class FinderBuffers(NamedTuple):
    """Filled anew for every frame."""

    places: Floats
    """x, y at marker height [m] and area [m^2] of each blob, for each marker; shape (markers, blobs, 3)."""
    listed: NDArray[np.int32]
    """Blobs that may belong to a team's robot, shape (blobs,)."""
    cell_heads: NDArray[np.int32]
    """First blob of each grid cell, or NO_BLOB; shape (64, 64)."""
    next_in_cell: NDArray[np.int32]
    """The next blob of the same cell, shape (blobs,)."""
    neighbors: Table
    """Blobs round the anchor in question, NEIGHBOR, shape (24,)."""
    assigned: NDArray[np.int32]
    """Neighbor in each slot, or NO_BLOB; shape (8,)."""
    anchor_shape: Table
    """Of the anchor in question, MEASURED_SHAPE, shape (1,)."""
    hypotheses: Table
    """HYPOTHESIS, shape (4096,)."""
    order: NDArray[np.int32]
    """Hypotheses, best first; shape (4096,)."""
    used: Mask
    """Whether a selected hypothesis has the blob, shape (blobs,)."""
    selected: NDArray[np.int32]
    """Hypotheses that are robots, shape (64,)."""
    ambiguous: Mask
    """Whether their headings are, shape (64,)."""
    alike: Mask
    """Whether another marker of the same team explains the robot about as well, shape (64,)."""
    unsure: Mask
    """Whether a robot's blobs do not tell its id for sure, shape (64,)."""
    centers: Floats
    """x, y [m] and weight [1/m^2] of a robot's patches, the anchor first; weight 0: not seen. Shape (9, 3)."""
    predicted: Table
    """Two known robots, the next one and the one that is measured: PREDICTED, shape (2,)."""
    known_px2: Floats
    """Squared radius of each verified robot in the picture, shape (64,)."""
    crossed: Floats
    """Its patches as they are found there: x, y [px] and area [px^2], later the deviation [px]; shape (9, 3)."""
    circle: Floats
    """Of ``circle_buffer``."""
    patches: Floats
    """Measured patches of each robot, see ``marker_reading``; shape (64, 9, PATCH_COLUMNS)."""
    learned: Floats
    """What the robots of this frame show of each color class, see ``marker_reading``; shape (256, 6)."""
    found: Table
    """Robots before they are ordered, shape (64,)."""


def finder_buffers(max_blobs: int, markers: int) -> FinderBuffers:
    """Buffers for frames of at most so many blobs, and so many markers of both teams."""
    return FinderBuffers(
        places=np.zeros((markers, max_blobs, 3)),
        listed=np.zeros(max_blobs, dtype=np.int32),
        cell_heads=np.full((GRID_CELLS, GRID_CELLS), NO_BLOB, dtype=np.int32),
        next_in_cell=np.zeros(max_blobs, dtype=np.int32),
        neighbors=np.zeros(MAX_NEIGHBORS, dtype=NEIGHBOR),
        assigned=np.full(MAX_SLOTS, NO_BLOB, dtype=np.int32),
        anchor_shape=np.zeros(1, dtype=MEASURED_SHAPE),
        hypotheses=np.zeros(MAX_HYPOTHESES, dtype=HYPOTHESIS),
        order=np.zeros(MAX_HYPOTHESES, dtype=np.int32),
        used=np.zeros(max_blobs, dtype=np.bool_),
        selected=np.zeros(MAX_ROBOTS, dtype=np.int32),
        ambiguous=np.zeros(MAX_ROBOTS, dtype=np.bool_),
        alike=np.zeros(MAX_ROBOTS, dtype=np.bool_),
        unsure=np.zeros(MAX_ROBOTS, dtype=np.bool_),
        centers=np.zeros((1 + MAX_SLOTS, 3)),
        known_px2=np.zeros(MAX_ROBOTS),
        predicted=np.zeros(2, dtype=PREDICTED),
        crossed=np.zeros((1 + MAX_SLOTS, 3)),
        circle=circle_buffer(),
        patches=np.zeros((MAX_ROBOTS, 1 + MAX_SLOTS, PATCH_COLUMNS)),
        learned=np.zeros((256, 6)),
        found=np.zeros(MAX_ROBOTS, dtype=ROBOT),
    )
