"""Task: images -> how light the field is in them, and what is wrong with that."""

from vision_core.geometry import Bytes
from vision_core.regions.exposure import exposure_check, field_pixels
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.watching import watching
from vision_core.types.regions import ExposureCheck


def start(handle: Handle) -> Step:
    """Spread points over the field."""
    camera = handle.camera
    points = field_pixels(handle.settings.field, camera.model, camera.size_px)

    def look(pixels: Bytes) -> ExposureCheck:
        return exposure_check(pixels, points)

    return watching(handle, records.exposure(camera.name), look)
