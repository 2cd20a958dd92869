"""1. light -> image."""

from dataclasses import dataclass

from vision_core.clock import Instant
from vision_core.geometry import Bytes


@dataclass(frozen=True, slots=True)
class ImageFrame:
    """One picture of one camera."""

    camera: str
    number: int
    """Counts the captured images, from 1; perception skips some of them."""
    grabbed: Instant
    """When the image was grabbed: the driver's buffer time where there is one."""
    pixels: Bytes
    """Shape (height, width, 3), blue green red, 8 bits each."""
