"""Reference implementation: RobotView -> the exact ``see`` datagram (PSLV paper, section 3.2 and equation 1).

Readable and slow. The service writes its datagrams in compiled code (``pipeline.see_kernels``); tests and the benchmark
compare that code with this module, byte for byte.
"""

import math
from collections.abc import Mapping

import numpy as np

from vision_core.clock import NS_PER_US, Instant
from vision_core.geometry import Bytes, Floats
from vision_core.models.mirror import MM_PER_M, Mirror
from vision_core.protocol.edge_codes import EdgeCodes
from vision_core.protocol.encoding import encode_see
from vision_core.protocol.messages import HIDDEN, NO_EXTRAS, NOTHING_PX, Ball, See
from vision_core.protocol.options import Options, ray_indices
from vision_core.types.edges import EdgeKind
from vision_core.types.views import BallView, RobotView

MAX_DISTANCE_M = 1e6
"""A larger distance is replaced by this one: its pixel is the horizon's, and its square is finite."""

_PADDED_HEX = np.frombuffer("".join(f"\0{value:02x}\0" for value in range(256)).encode(), dtype="<u4")
"""The two digits of each distance at their place in an edge: byte 0 is left free for the letter."""


def reference_see(
    view: RobotView,
    options: Options,
    mirror: Mirror,
    codes: EdgeCodes,
    boot: Instant,
    *,
    nul: bool = False,
    extras: Mapping[str, tuple[str, ...]] = NO_EXTRAS,
) -> bytes:
    """The datagram of a view as a client asked for it.

    view: its rays are evenly spaced over the circle, ray 0 ahead, anticlockwise. mirror: the field's, used unless the
    options have one. boot: where Time is 0. extras: what follows the ball. Raises ValueError unless the number of rays
    is a multiple of ``options.rays_per_circle``.
    """
    own = options.mirror or mirror
    px, kinds = reference_px(view, own), view.kinds
    chosen = ray_indices(options, len(kinds))
    if chosen is not None:
        px, kinds = px[chosen], kinds[chosen]
    letters = codes[options.types]
    types = np.where(px == NOTHING_PX, letters[EdgeKind.NOTHING], letters.take(kinds))
    edges = (_PADDED_HEX.take(px) | types).view(np.uint8).reshape(-1, 4)[:, :3]
    see = See((view.at - boot) // NS_PER_US, edges.tobytes(), reference_ball(view.ball, options, own), extras)
    return encode_see(see, options.time) + (b"\0" if nul else b"")


def reference_px(view: RobotView, mirror: Mirror) -> Bytes:
    """int(f^-1(r)) of every ray, at most 254 (the largest horizon of a mirror); 255 for nothing; shape (n,)."""
    far_mm: Floats = np.minimum(view.distances_m, MAX_DISTANCE_M) * MM_PER_M
    px = mirror.px_from_mm(far_mm).astype(np.uint8)
    px[(view.kinds == EdgeKind.NOTHING) | (view.distances_m == math.inf)] = NOTHING_PX
    return px


def reference_ball(ball: BallView | None, options: Options, mirror: Mirror) -> Ball:
    """The ball in whole pixels and degrees, halves rounded up; hidden outside the client's field of view."""
    if ball is None:
        return HIDDEN
    direction_deg = ball.direction_deg if options.sense == "ccw" else -ball.direction_deg
    if options.fov_deg < 360.0:
        off_center_deg = abs((direction_deg - options.center_deg + 180.0) % 360.0 - 180.0)
        if off_center_deg > (options.fov_deg + ball.size_deg) / 2.0:
            return HIDDEN
    size_deg = ball.size_deg if options.size == "full" else ball.size_deg / 2.0
    px = int(mirror.px_from_mm(ball.distance_m * MM_PER_M))
    return Ball(px, math.floor(direction_deg + 0.5) % 360, max(math.floor(size_deg + 0.5), 1))
