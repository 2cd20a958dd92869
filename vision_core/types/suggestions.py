"""Robots that the blobs do not show: where the slow search found them."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LiveSuggestions:
    """Where the task ``perceive`` looks for robots beside its blobs."""

    plain: tuple[float, float, float]
    """What the floor looks like, see ``objects.robots.marker_shape.Scene``."""
    poses: tuple[tuple[int, int, float, float, float], ...]
    """Place, marker, x [m], y [m], heading [rad], see ``objects.robots.confirmation_buffers.SUGGESTED``."""
