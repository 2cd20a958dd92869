"""The table of upright prisms of which a scene consists: robots, boards, feet, and the viewer's own body."""

import math
from typing import TypeAlias

import numpy as np

from vision_core.capture.synthetic.bodies import HEADING, TURN_RATE, VX, VY, X, Y
from vision_core.capture.synthetic.floor import BOARD_TOP, COLORS, Venue
from vision_core.capture.synthetic.sprites import Prism
from vision_core.geometry import Floats
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.types.edges import EdgeKind
from vision_core.types.field import Segment
from vision_core.types.tables import Table

Bgr: TypeAlias = tuple[float, float, float]

SOLID = np.dtype(
    [
        ("x_m", np.float64), ("y_m", np.float64), ("heading_rad", np.float64),
        ("vx_m_s", np.float64), ("vy_m_s", np.float64), ("turn_rad_s", np.float64),
        ("round", np.int32), ("half_length_m", np.float64), ("half_width_m", np.float64), ("front_m", np.float64),
        ("bottom_m", np.float64), ("top_m", np.float64), ("band_low_m", np.float64), ("band_high_m", np.float64),
        ("first_patch", np.int32), ("end_patch", np.int32), ("kind", np.int32),
        ("top_bgr", np.float64, 3), ("side_bgr", np.float64, 3), ("band_bgr", np.float64, 3),
    ]
)  # fmt: skip
"""An upright prism: pose and velocity; if round a disc of radius half_length_m, cut flat at x = front_m, else a
rectangle; from bottom_m to top_m over the floor; a band round its side; its patches on the top; EdgeKind code (a
robot's number added), NOTHING for the viewer's own body; colors."""

GOAL_SHADE = 0.75
"""Goals are painted in their color, so much darker than the paper of markers."""


def prism_solid(prism: Prism, body: Floats, kind: int, patches: tuple[int, int] = (0, 0)) -> Table:
    """A prism of the simulated world, standing at a body's pose; shape (1,). patches: first and end (exclusive)."""
    solid = np.zeros(1, dtype=SOLID)
    row = solid[0]
    row["x_m"], row["y_m"], row["heading_rad"] = body[X], body[Y], body[HEADING]
    row["vx_m_s"], row["vy_m_s"], row["turn_rad_s"] = body[VX], body[VY], body[TURN_RATE]
    row["round"], row["half_length_m"], row["half_width_m"] = not prism.square, prism.radius, prism.radius
    row["front_m"], row["top_m"], row["kind"] = prism.front, prism.height, kind
    row["first_patch"], row["end_patch"] = patches
    row["top_bgr"], row["side_bgr"] = prism.colors[0], prism.colors[1]
    return solid


def boards(segments: tuple[Segment, ...], venue: Venue) -> Table:
    """Walls and goals as boxes whose inner faces are the field's solid segments; shape (n,), walls first.

    A board is longer than its segment, by its thickness, at an end that another segment of the same kind continues.
    Where a goal's side meets a wall, the wall's end is seen.
    """
    solid = sorted((segment for segment in segments if segment.solid), key=lambda segment: segment.kind)
    table = np.zeros(len(solid), dtype=SOLID)
    for number, segment in enumerate(solid):
        alike = [other for other in solid if other.kind == segment.kind]
        _stand_board(table[number : number + 1], segment, alike, venue)
    return table


def _stand_board(row: Table, segment: Segment, alike: list[Segment], venue: Venue) -> None:
    """Fill in the board, shape (1,), of a segment; alike: all segments of its kind, which enclose some floor."""
    ends = np.array([[segment.x1_m, segment.y1_m], [segment.x2_m, segment.y2_m]])
    corners = np.array([[[other.x1_m, other.y1_m], [other.x2_m, other.y2_m]] for other in alike])
    along = (ends[1] - ends[0]) / math.hypot(*(ends[1] - ends[0]))
    outward = np.array([along[1], -along[0]])
    if outward @ (ends.mean(axis=0) - corners.mean(axis=(0, 1))) < 0.0:
        outward = -outward
    for end, away in ((0, -along), (1, along)):
        if (np.abs(corners - ends[end]).max(axis=2) < 1e-9).sum() > 1:
            ends[end] = ends[end] + venue.thickness * away
    middle = ends.mean(axis=0) + 0.5 * venue.thickness * outward
    row["x_m"], row["y_m"], row["heading_rad"] = middle[0], middle[1], math.atan2(along[1], along[0])
    row["half_length_m"], row["half_width_m"] = 0.5 * math.hypot(*(ends[1] - ends[0])), 0.5 * venue.thickness
    row["top_m"], row["kind"] = venue.height, segment.kind
    row["top_bgr"] = row["side_bgr"] = _board_bgr(segment.kind)


def _board_bgr(kind: EdgeKind) -> Floats:
    """Walls are white, goals have the color of the team that defends them."""
    if kind is EdgeKind.WALL:
        return np.asarray(COLORS[BOARD_TOP])
    return GOAL_SHADE * np.array(PAINTS_BGR["blue" if kind is EdgeKind.GOAL_BLUE else "yellow"], dtype=np.float64)
