"""What the robot of a trial sees: the four walls of a square room in which it turns on the spot, and a ball."""

import numpy as np

from vision_core.clock import NS_PER_US, Instant
from vision_core.models.mirror import Mirror
from vision_core.protocol.edge_codes import edge_codes
from vision_core.protocol.encoding import encode_see
from vision_core.protocol.lifecycle import Session
from vision_core.protocol.messages import HIDDEN, See
from vision_core.protocol.see import reference_see
from vision_core.types.edges import EdgeKind
from vision_core.types.views import BallView, RobotView

WALLS_M = 1.2
BALL = BallView(distance_m=0.379, direction_deg=121.2, size_deg=6.45, partial=False)
CODES = edge_codes()


def view_of(session: Session, mirror: Mirror, turn_deg: float, time_ns: int) -> bytes:
    """A view. time_ns: since the server's start."""
    angles = np.arange(session.options.rays_per_circle) * 2.0 * np.pi / session.options.rays_per_circle
    angles += np.deg2rad(turn_deg)
    distances_m = WALLS_M / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    kinds = np.full(len(angles), EdgeKind.WALL, dtype=np.uint8)
    view = RobotView(session.team, session.number, Instant(time_ns), 0, distances_m, kinds, BALL, False)
    return reference_see(view, session.options, mirror, CODES, Instant(0), nul=session.nul)


def unseen(session: Session, time_ns: int) -> bytes:
    """What version 2 is told while the camera does not see the robot."""
    see = See(time_ns // NS_PER_US, b"-ff" * session.options.directions, HIDDEN, {"flags": ("nopose",)})
    return encode_see(see, session.options.time) + (b"\0" if session.nul else b"")
