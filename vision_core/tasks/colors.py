"""Task: images -> how far their light has drifted from the one that the colors were tuned in."""

from vision_core.color.light import field_samples, light_of
from vision_core.geometry import Bytes
from vision_core.models.from_settings import camera_model_from
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.watching import watching
from vision_core.types.regions import ColorDrift


def start(handle: Handle) -> Step:
    """Spread samples over the field, and load the kernel."""
    settings = handle.settings
    size, light = (settings.camera.width_px, settings.camera.height_px), settings.colors.light
    samples = field_samples(camera_model_from(settings), settings.field, size, light.margin_m)

    def look(pixels: Bytes) -> ColorDrift:
        seen = light_of(pixels, samples, light)
        return ColorDrift(seen.gain_bgr, seen.reason)

    return watching(handle, records.colors(settings.camera.name), look)
