"""Task: images -> how light the field is in them, and what is wrong with that."""

from vision_core.geometry import Bytes
from vision_core.models.from_settings import camera_model_from
from vision_core.regions.exposure import exposure_check, field_pixels
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.watching import watching
from vision_core.types.regions import ExposureCheck


def start(handle: Handle) -> Step:
    """Spread points over the field."""
    settings = handle.settings
    size = settings.camera.width_px, settings.camera.height_px
    points = field_pixels(settings.field, camera_model_from(settings), size)

    def look(pixels: Bytes) -> ExposureCheck:
        return exposure_check(pixels, points)

    return watching(handle, records.exposure(settings.camera.name), look)
