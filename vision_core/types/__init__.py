"""What flows: passive, frozen records, in the order of the flow.

light -> :class:`ImageFrame` -> color classes -> :class:`Blobs` -> :class:`Sightings` ->
:class:`World` -> :class:`RobotView` -> datagram

Records hold no code beyond trivial derived values. Stages are functions from records to records.
"""

from vision_core.types.blobs import Blobs
from vision_core.types.colors import ColorTable
from vision_core.types.field import Arc, EdgeKind, Segment
from vision_core.types.image import ImageFrame
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.tracks import BallTrack, RobotTrack, World
from vision_core.types.views import BallView, RobotView

__all__ = [
    "Arc",
    "BallSighting",
    "BallTrack",
    "BallView",
    "Blobs",
    "ColorTable",
    "EdgeKind",
    "ImageFrame",
    "RobotSighting",
    "RobotTrack",
    "RobotView",
    "Segment",
    "Sightings",
    "Team",
    "World",
]
