"""One frame as the finders of robots and balls get it."""

from typing import NamedTuple

from vision_core.geometry import Bytes
from vision_core.models.camera_kernels import CameraMap
from vision_core.types.tables import Table


class Observation(NamedTuple):
    """A frame, its blobs and the camera that took it. Kernels take it as one argument."""

    blobs: Table
    """BLOB table."""
    blob_count: int
    """Rows of the table that hold a blob."""
    pixels: Bytes
    """Shape (height, width, 3), blue green red."""
    classes: Bytes
    """Of the ColorTable, shape (65536,)."""
    camera: CameraMap
